#include "batch/layouts.h"

#include <map>

#include <gtest/gtest.h>

#include "orbifit/model/errors.h"

#include "temporary_folder.h"

namespace orbifit::batch {
namespace {

using Files = std::vector<std::string>;

// What is found, ids and paths below the folder, in a tree of these files.
std::map<std::string, std::string> found(const std::string& layout, const Files& files) {
  const TemporaryFolder folder;
  for (const std::string& file : files) {
    std::filesystem::create_directories(folder.file(file).parent_path());
    folder.write(file, "x");
  }
  std::map<std::string, std::string> result;
  for_each_item(layout, folder.path(), [&](const Item& item) {
    result[item.id] = item.mesh.lexically_relative(folder.path()).generic_string();
  });
  return result;
}

using Found = std::map<std::string, std::string>;

TEST(Layouts, TakeTheMeshesOfEachDataSet) {
  EXPECT_EQ(
      found("shapenet", {"02691156/a1/models/model_normalized.obj", "02691156/a1/models/model_normalized.mtl",
                         "02691156/a1/images/t.jpg", "03001627/b2/model.obj", "taxonomy.json"}),
      (Found{{"02691156/a1", "02691156/a1/models/model_normalized.obj"}, {"03001627/b2", "03001627/b2/model.obj"}}));
  EXPECT_EQ(found("modelnet", {"ModelNet40/chair/train/chair_0001.off", "ModelNet40/chair/test/chair_0890.off",
                               "ModelNet40/README.txt"}),
            (Found{{"chair/train/chair_0001", "ModelNet40/chair/train/chair_0001.off"},
                   {"chair/test/chair_0890", "ModelNet40/chair/test/chair_0890.off"}}));
  EXPECT_EQ(
      found("partnet", {"data_v0/173/objs/new-0.obj", "data_v0/173/objs/original-2.obj", "data_v0/173/result.json"}),
      (Found{{"173/new-0", "data_v0/173/objs/new-0.obj"}, {"173/original-2", "data_v0/173/objs/original-2.obj"}}));
  EXPECT_EQ(found("abc", {"abc_0000_obj_v00/00000002/00000002_1ffb81a71e5b402e966b9341_trimesh_000.obj",
                          "00000003/00000003_1ffb81a71e5b402e966b9341_features_000.yml"}),
            (Found{{"00000002/000", "abc_0000_obj_v00/00000002/00000002_1ffb81a71e5b402e966b9341_trimesh_000.obj"}}));
  EXPECT_EQ(found("thingi10k", {"Thingi10K/raw_meshes/32770.stl", "Thingi10K/metadata/a.csv"}),
            (Found{{"32770", "Thingi10K/raw_meshes/32770.stl"}}));
  EXPECT_EQ(
      found("objaverse", {"hf-objaverse-v1/glbs/000-023/8476c4170df24cf5bbe6967222d1a42d.glb", "object-paths.json.gz"}),
      (Found{{"000-023/8476c4170df24cf5bbe6967222d1a42d",
              "hf-objaverse-v1/glbs/000-023/8476c4170df24cf5bbe6967222d1a42d.glb"}}));
  EXPECT_EQ(found("ycb", {"003_cracker_box/google_16k/nontextured.ply", "003_cracker_box/google_16k/textured.obj",
                          "003_cracker_box/tsdf/nontextured.ply", "072-a_toy_airplane/tsdf/nontextured.stl"}),
            (Found{{"003_cracker_box", "003_cracker_box/google_16k/nontextured.ply"},
                   {"072-a_toy_airplane", "072-a_toy_airplane/tsdf/nontextured.stl"}}));
  EXPECT_EQ(found("gso", {"11pro_SL_TRX_FG/meshes/model.obj", "11pro_SL_TRX_FG/meshes/model.mtl"}),
            (Found{{"11pro_SL_TRX_FG", "11pro_SL_TRX_FG/meshes/model.obj"}}));
  EXPECT_EQ(found("bop", {"lm/models/obj_000001.ply", "lm/models_eval/obj_000001.ply", "lm/models/models_info.json"}),
            (Found{{"lm/obj_000001", "lm/models/obj_000001.ply"}}));
}

TEST(Layouts, EachIsKnownAndOthersAreRefused) {
  EXPECT_EQ(known_layouts().size(), 9U);
  for (const Layout& layout : known_layouts())
    EXPECT_THROW(found(layout.name, {"other.txt"}), InputError) << layout.name;
  EXPECT_THROW(found("scannet", {"a.ply"}), UsageError);
}

}  // namespace
}  // namespace orbifit::batch
