#include "three_mf_package.h"

#include <array>
#include <stdexcept>
#include <utility>

#include <zip.h>

namespace orbifit {

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
