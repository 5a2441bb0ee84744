#include "three_mf_sample.h"

#include <stdexcept>
#include <vector>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wold-style-cast"
#include <Model/COM/NMR_DLLInterfaces.h>
#pragma GCC diagnostic pop

namespace orbifit {

namespace {

using ThreeMfHandle = NMR::PLib3MFBase*;

void expect_done(LIB3MFRESULT result) {
  if (result != 0) throw std::runtime_error("lib3mf: " + std::to_string(result));
}

NMR::MODELTRANSFORM transform_of(const ThreeMfSample::Place& place) {
  NMR::MODELTRANSFORM result{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) result.m_fFields[i][j] = static_cast<float>(place(i, j));
  }
  return result;
}

ThreeMfHandle add_mesh(ThreeMfHandle model, const Mesh& mesh) {
  ThreeMfHandle object = nullptr;
  expect_done(NMR::lib3mf_model_addmeshobject(model, &object));
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    NMR::MODELMESHVERTEX vertex{};
    for (int k = 0; k < 3; ++k) vertex.m_fPosition[k] = static_cast<float>(mesh.vertices(v, k));
    expect_done(NMR::lib3mf_meshobject_addvertex(object, &vertex, nullptr));
  }
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    NMR::MODELMESHTRIANGLE triangle{};
    for (int k = 0; k < 3; ++k) triangle.m_nIndices[k] = static_cast<DWORD>(mesh.faces(f, k));
    expect_done(NMR::lib3mf_meshobject_addtriangle(object, &triangle, nullptr));
  }
  return object;
}

}  // namespace

ThreeMfSample::Place ThreeMfSample::at(double x, double y, double z) {
  Place place = Place::Identity();
  place.col(3) << x, y, z;
  return place;
}

void ThreeMfSample::write(const std::filesystem::path& file) const {
  std::vector<ThreeMfHandle> given;
  ThreeMfHandle model = nullptr;
  expect_done(NMR::lib3mf_createmodel(&model));
  given.push_back(model);
  expect_done(NMR::lib3mf_model_setunit(model, static_cast<DWORD>(unit)));
  std::vector<ThreeMfHandle> handles;
  for (const Object& object : objects) {
    ThreeMfHandle handle = nullptr;
    if (object.components.empty()) {
      handle = add_mesh(model, object.mesh);
    } else {
      expect_done(NMR::lib3mf_model_addcomponentsobject(model, &handle));
      for (const Component& component : object.components) {
        NMR::MODELTRANSFORM transform = transform_of(component.place);
        ThreeMfHandle added = nullptr;
        expect_done(NMR::lib3mf_componentsobject_addcomponent(
            handle, handles.at(static_cast<std::size_t>(component.object)), &transform, &added));
        given.push_back(added);
      }
    }
    expect_done(NMR::lib3mf_object_setnameutf8(handle, object.name.c_str()));
    handles.push_back(handle);
    given.push_back(handle);
  }
  for (const Component& item : items) {
    NMR::MODELTRANSFORM transform = transform_of(item.place);
    ThreeMfHandle added = nullptr;
    expect_done(
        NMR::lib3mf_model_addbuilditem(model, handles.at(static_cast<std::size_t>(item.object)), &transform, &added));
    given.push_back(added);
  }
  ThreeMfHandle writer = nullptr;
  expect_done(NMR::lib3mf_model_querywriter(model, "3mf", &writer));
  given.push_back(writer);
  expect_done(NMR::lib3mf_writer_writetofileutf8(writer, file.c_str()));
  for (auto handle = given.rbegin(); handle != given.rend(); ++handle) NMR::lib3mf_release(*handle);
}

}  // namespace orbifit
