#include "three_mf_sample.h"

#include <array>
#include <stdexcept>
#include <utility>

#include <zip.h>

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

void write_three_mf_of(const std::filesystem::path& file, const std::string& model) {
  const std::string types =
      R"(<?xml version="1.0"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">)"
      R"(<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>)"
      R"(<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>)";
  const std::string relations =
      R"(<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">)"
      R"(<Relationship Target="/3D/3dmodel.model" Id="r" Type=)"
      R"("http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>)";
  zip_t* archive = zip_open(file.c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
  for (const auto& [name, text] : std::array<std::pair<const char*, const std::string*>, 3>{
           {{"[Content_Types].xml", &types}, {"_rels/.rels", &relations}, {"3D/3dmodel.model", &model}}}) {
    zip_file_add(archive, name, zip_source_buffer(archive, text->data(), text->size(), 0), 0);
  }
  if (zip_close(archive) != 0) throw std::runtime_error("libzip cannot write " + file.string());
}

}  // namespace orbifit
