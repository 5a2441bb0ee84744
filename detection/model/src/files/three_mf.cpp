#include "files/three_mf.h"

#include "orbifit/model/errors.h"

#include "files/mesh_formats.h"
#include "files/three_mf_bounds.h"

#ifdef ORBIFIT_PORTABLE

namespace orbifit {

ThreeMfContent read_three_mf_content(const std::filesystem::path& file, std::string_view /*content*/,
                                     MeshBuilder& /*builder*/) {
  throw InputError(file.string(), "", "3MF is not read here: convert the file with the program");
}

}  // namespace orbifit

#else

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>

#include <Eigen/LU>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wold-style-cast"
#include <Common/NMR_ErrorConst.h>
#include <Model/COM/NMR_DLLInterfaces.h>
#pragma GCC diagnostic pop

namespace orbifit {

namespace fs = std::filesystem;

namespace {

using Handle = NMR::PLib3MFBase*;

// What lib3mf gives out, given back to it.
class Held {
 public:
  explicit Held(Handle handle) : handle_(handle) {}
  Held(Held&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  Held& operator=(Held&&) = delete;
  ~Held() {
    if (handle_ != nullptr) NMR::lib3mf_release(handle_);
  }
  Handle get() const { return handle_; }

 private:
  Handle handle_;
};

// What an object multiplies to.
struct Extent {
  std::int64_t vertices = 0, parts = 1;

  Extent& operator+=(const Extent& other) {  // of numbers that end far below the largest
    vertices = std::min(vertices + other.vertices, kMostVertices + 1);
    parts = std::min(parts + other.parts, kMostThreeMfParts + 1);
    return *this;
  }
};

struct Component {
  std::int64_t object = 0;
  Eigen::Matrix<double, 3, 4> place;
};

struct Object {
  std::string name;
  std::vector<NMR::MODELMESHVERTEX> vertices;
  std::vector<NMR::MODELMESHTRIANGLE> triangles;
  std::vector<Component> components;
  Extent extent;
};

class ThreeMfReader {
 public:
  ThreeMfReader(const fs::path& file, std::string_view content, MeshBuilder& builder)
      : file_(file), builder_(builder), model_(get("", nullptr, NMR::lib3mf_createmodel)) {
    check_three_mf_bounds(file, content);
    const Held reader = get("", model_.get(), NMR::lib3mf_model_queryreader, "3mf");
    std::string bytes(content);  // which lib3mf would be free to change
    const auto result = NMR::lib3mf_reader_readfrombuffer(reader.get(), reinterpret_cast<BYTE*>(bytes.data()),
                                                          static_cast<ULONG64>(bytes.size()));
    if (result != 0) refuse("", "cannot be read as 3MF: " + last_error(reader.get()));
    read_warnings(reader.get());
  }

  ThreeMfContent read() {
    DWORD unit = 0;
    check("", model_.get(), NMR::lib3mf_model_getunit(model_.get(), &unit));
    constexpr std::array<const char*, 6> kUnits{"micrometre", "millimetre", "centimetre", "inch", "foot", "metre"};
    content_.unit = kUnits.at(unit);
    read_objects();
    const std::vector<Component> items = build_items();
    content_.items = static_cast<std::int64_t>(items.size());
    Extent whole;
    for (const Component& item : items) whole += object(item.object, "build").extent;
    if (whole.vertices > kMostVertices || whole.parts > kMostThreeMfParts) {
      refuse("build", "its components multiply to more than 200 million vertices or a million parts");
    }
    for (const Component& item : items) add(item);
    return std::move(content_);
  }

 private:
  [[noreturn]] void refuse(const std::string& where, const std::string& reason) const {
    throw InputError(file_.string(), where, reason);
  }

  static std::string last_error(Handle handle) {
    DWORD code = 0;
    LPCSTR text = nullptr;
    NMR::lib3mf_getlasterror(handle, &code, &text);
    return text != nullptr && *text != '\0' ? text : "error " + std::to_string(code);
  }

  void check(const std::string& where, Handle handle, LIB3MFRESULT result) const {
    if (result != 0) refuse(where, "cannot be read as 3MF: " + last_error(handle));
  }

  // Calls a function of lib3mf whose last argument is a handle that it gives out.
  template <class Function, class... Arguments>
  Held get(const std::string& where, Handle of, Function function, Arguments... arguments) const {
    Handle result = nullptr;
    if constexpr (std::is_same_v<Function, decltype(&NMR::lib3mf_createmodel)>) {
      if (function(&result) != 0) refuse(where, "lib3mf cannot begin");
    } else {
      check(where, of, function(of, arguments..., &result));
    }
    return Held(result);
  }

  // Names and messages, whose length lib3mf tells first.
  template <class Call>
  static std::string text(const Call& call) {
    ULONG needed = 0;
    if (call(nullptr, 0, &needed) != 0 || needed == 0) return "";
    std::string result(needed + 1, '\0');
    if (call(result.data(), static_cast<ULONG>(result.size()), &needed) != 0) return "";
    result.resize(result.find('\0'));
    return result;
  }

  void read_warnings(Handle reader) {
    DWORD count = 0;
    check("", reader, NMR::lib3mf_reader_getwarningcount(reader, &count));
    constexpr DWORD kMost = 20;  // of one damaged file there may be a warning for each triangle
    for (DWORD w = 0; w < std::min(count, kMost); ++w) {
      DWORD code = 0;
      content_.warnings.push_back(text([&](LPSTR buffer, ULONG size, ULONG* needed) {
        return NMR::lib3mf_reader_getwarningutf8(reader, w, &code, buffer, size, needed);
      }));
      if (code == NMR_ERROR_REQUIREDEXTENSIONNOTSUPPORTED) {  // the shape would lack what the extension says
        refuse("requiredextensions", "names an extension of 3MF that cannot be read");
      }
    }
  }

  Eigen::Matrix<double, 3, 4> matrix(const NMR::MODELTRANSFORM& transform, const std::string& where) const {
    Eigen::Matrix<double, 3, 4> result;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 4; ++j) result(i, j) = transform.m_fFields[i][j];
    }
    if (!result.allFinite()) refuse(where, "has a transform that is not finite");
    return result;
  }

  // Objects may name those alone that stand before them in the file: lib3mf sees to it, and gives them in that order.
  void read_objects() {
    const Held objects = get("", model_.get(), NMR::lib3mf_model_getobjects);
    BOOL more = 0;
    while (NMR::lib3mf_resourceiterator_movenext(objects.get(), &more) == 0 && more != 0) {
      const Held resource = get("", objects.get(), NMR::lib3mf_resourceiterator_getcurrent);
      DWORD id = 0;
      check("", resource.get(), NMR::lib3mf_resource_getresourceid(resource.get(), &id));
      const std::string where = "object " + std::to_string(id);
      Object object;
      object.name = text([&](LPSTR buffer, ULONG size, ULONG* needed) {
        return NMR::lib3mf_object_getnameutf8(resource.get(), buffer, size, needed);
      });
      BOOL is_mesh = 0;
      check(where, resource.get(), NMR::lib3mf_object_ismeshobject(resource.get(), &is_mesh));
      if (is_mesh != 0) {
        read_mesh_object(resource.get(), where, object);
      } else {
        read_components(resource.get(), where, object);
      }
      objects_[id] = std::move(object);
    }
    content_.objects = static_cast<std::int64_t>(objects_.size());
  }

  void read_mesh_object(Handle mesh, const std::string& where, Object& object) const {
    DWORD vertices = 0;
    DWORD triangles = 0;
    check(where, mesh, NMR::lib3mf_meshobject_getvertexcount(mesh, &vertices));
    check(where, mesh, NMR::lib3mf_meshobject_gettrianglecount(mesh, &triangles));
    object.vertices.resize(vertices);
    object.triangles.resize(triangles);
    if (vertices > 0) {
      check(where, mesh, NMR::lib3mf_meshobject_getvertices(mesh, object.vertices.data(), vertices, nullptr));
    }
    if (triangles > 0) {
      check(where, mesh, NMR::lib3mf_meshobject_gettriangleindices(mesh, object.triangles.data(), triangles, nullptr));
    }
    object.extent.vertices = vertices;
  }

  void read_components(Handle components, const std::string& where, Object& object) {
    DWORD count = 0;
    check(where, components, NMR::lib3mf_componentsobject_getcomponentcount(components, &count));
    for (DWORD c = 0; c < count; ++c) {
      const Held component = get(where, components, NMR::lib3mf_componentsobject_getcomponent, c);
      DWORD id = 0;
      NMR::MODELTRANSFORM transform{};
      check(where, component.get(), NMR::lib3mf_component_getobjectresourceid(component.get(), &id));
      check(where, component.get(), NMR::lib3mf_component_gettransform(component.get(), &transform));
      object.components.push_back({id, matrix(transform, where)});
      object.extent += this->object(id, where).extent;
    }
  }

  std::vector<Component> build_items() const {
    std::vector<Component> items;
    const Held all = get("build", model_.get(), NMR::lib3mf_model_getbuilditems);
    BOOL more = 0;
    while (NMR::lib3mf_builditemiterator_movenext(all.get(), &more) == 0 && more != 0) {
      const Held item = get("build", all.get(), NMR::lib3mf_builditemiterator_getcurrent);
      DWORD id = 0;
      NMR::MODELTRANSFORM transform{};
      check("build", item.get(), NMR::lib3mf_builditem_getobjectresourceid(item.get(), &id));
      check("build", item.get(), NMR::lib3mf_builditem_getobjecttransform(item.get(), &transform));
      items.push_back({id, matrix(transform, "build")});
    }
    return items;
  }

  const Object& object(std::int64_t id, const std::string& user) const {
    const auto found = objects_.find(id);
    if (found == objects_.end())
      refuse(user, "names object " + std::to_string(id) + ", which does not stand before it");
    return found->second;
  }

  // Depth first, components in order; with a stack of our own, so that no depth overflows the call stack.
  void add(const Component& item) {
    struct Open {
      Component component;
      std::string name;  // of the nearest object that holds this
    };
    std::vector<Open> stack{{item, ""}};
    while (!stack.empty()) {
      const Open open = std::move(stack.back());
      stack.pop_back();
      const Object& own = object(open.component.object, "build");
      const std::string& name = own.name.empty() ? open.name : own.name;
      if (!own.vertices.empty()) add_mesh(own, open.component, name);
      for (auto child = own.components.rbegin(); child != own.components.rend(); ++child) {
        Component placed = *child;
        const auto& place = open.component.place;
        placed.place = place.leftCols<3>() * child->place;
        placed.place.col(3) += place.col(3);
        stack.push_back({placed, name});
      }
    }
  }

  void add_mesh(const Object& object, const Component& component, const std::string& name) {
    content_.parts.push_back({name, component.object, faces_});
    const std::int64_t first = builder_.vertices();
    for (const NMR::MODELMESHVERTEX& vertex : object.vertices) {
      const Eigen::Vector4d local(vertex.m_fPosition[0], vertex.m_fPosition[1], vertex.m_fPosition[2], 1);
      const Eigen::Vector3d point = component.place * local;
      builder_.add_vertex({point.x(), point.y(), point.z()}, 0);
    }
    const bool mirrored = component.place.leftCols<3>().determinant() < 0;  // turns the triangles over
    for (const NMR::MODELMESHTRIANGLE& triangle : object.triangles) {
      std::int64_t corners[3] = {triangle.m_nIndices[0], triangle.m_nIndices[mirrored ? 2 : 1],
                                 triangle.m_nIndices[mirrored ? 1 : 2]};
      for (std::int64_t& corner : corners) corner += first;
      builder_.add_polygon(corners, 0);
      ++faces_;
    }
  }

  const fs::path& file_;
  MeshBuilder& builder_;
  Held model_;
  std::map<std::int64_t, Object> objects_;
  ThreeMfContent content_;
  std::int64_t faces_ = 0;
};

}  // namespace

ThreeMfContent read_three_mf_content(const fs::path& file, std::string_view content, MeshBuilder& builder) {
  return ThreeMfReader(file, content, builder).read();
}

}  // namespace orbifit

#endif

namespace orbifit {

void read_three_mf(const std::filesystem::path& file, std::string_view content, MeshBuilder& builder) {
  read_three_mf_content(file, content, builder);
}

}  // namespace orbifit
