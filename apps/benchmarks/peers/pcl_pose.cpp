#include "pcl_pose.h"

#include <cstddef>
#include <cstdlib>

#include <pcl/features/fpfh_omp.h>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/sample_consensus_prerejective.h>

#include "orbifit/interop/pcl.h"

#include "geometry/sampling.h"

namespace orbifit::benchmarks {

namespace {

using Cloud = pcl::PointCloud<pcl::PointNormal>;
using Features = pcl::PointCloud<pcl::FPFHSignature33>;

// What PCL's tutorial "Robust pose estimation of rigid objects" sets, whose leaf of 5 mm is 1/50 of its object.
constexpr double kLeaf = 0.02;            // of the template's diagonal
constexpr double kNormalRadius = 2;       // in leaves, as all that follows
constexpr double kFeatureRadius = 5;      //
constexpr double kInlierDistance = 2.5;   //
constexpr int kIterations = 50000;        //
constexpr int kSamples = 3;               // correspondences of a hypothesis
constexpr int kRandomness = 5;            // one of so many nearest features
constexpr float kInlierFraction = 0.25F;  // of the template, which a view shows half of
constexpr int kIcpIterations = 100;
constexpr int kTemplatePoints = 50000;  // before VoxelGrid: a dozen or more a leaf

Cloud::Ptr thinned(const Cloud::Ptr& cloud, double leaf) {
  Cloud::Ptr result(new Cloud);
  pcl::VoxelGrid<pcl::PointNormal> grid;
  grid.setInputCloud(cloud);
  grid.setLeafSize(static_cast<float>(leaf), static_cast<float>(leaf), static_cast<float>(leaf));
  grid.filter(*result);
  for (pcl::PointNormal& point : *result) point.getNormalVector3fMap().normalize();
  return result;
}

// With normals towards where each point was seen from.
Cloud::Ptr scanned(const PointCloud& scan, const Eigen::Vector3d& origin, double leaf, int threads) {
  PointCloud near_origin = scan;
  near_origin.points.rowwise() -= origin.transpose();
  near_origin.viewpoints.resize(0, 3);
  Cloud::Ptr cloud(new Cloud(to_pcl<pcl::PointNormal>(near_origin)));
  pcl::NormalEstimationOMP<pcl::PointNormal, pcl::PointNormal> normals(static_cast<unsigned>(threads));
  normals.setInputCloud(cloud);
  normals.setRadiusSearch(kNormalRadius * leaf);
  normals.compute(*cloud);
  Cloud::Ptr result(new Cloud);
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    pcl::PointNormal& point = (*cloud)[i];
    const auto row = static_cast<Eigen::Index>(i);
    point.getVector3fMap() = near_origin.points.row(row).transpose().cast<float>();
    if (!point.getNormalVector3fMap().allFinite()) continue;  // a point by itself
    if (scan.viewpoints.rows() > 0) {
      const Eigen::Vector3d view = scan.viewpoints.row(scan.viewpoints.rows() == 1 ? 0 : row).transpose() - origin;
      if ((view.cast<float>() - point.getVector3fMap()).dot(point.getNormalVector3fMap()) < 0) {
        point.getNormalVector3fMap() *= -1;
      }
    }
    result->push_back(point);
  }
  return thinned(result, leaf);
}

Cloud::Ptr sampled(const Mesh& mesh, double scale, double leaf, const RunContext& context) {
  Random random(context.seed, "PCL's template");
  const SurfaceSamples samples = sample_surface(mesh, kTemplatePoints, random);
  const PointCloud points{scale * samples.points, samples.normals, Points(0, 3)};
  return thinned(Cloud::Ptr(new Cloud(to_pcl<pcl::PointNormal>(points))), leaf);
}

Features::Ptr features_of(const Cloud::Ptr& cloud, double leaf, int threads) {
  Features::Ptr features(new Features);
  pcl::FPFHEstimationOMP<pcl::PointNormal, pcl::PointNormal, pcl::FPFHSignature33> estimation(
      static_cast<unsigned>(threads));
  estimation.setInputCloud(cloud);
  estimation.setInputNormals(cloud);
  estimation.setRadiusSearch(kFeatureRadius * leaf);
  estimation.compute(*features);
  return features;
}

// Template -> scan.
std::optional<Eigen::Matrix4f> rough_pose(const Cloud::Ptr& model, const Cloud::Ptr& scene, double leaf, int threads,
                                          double similarity) {
  pcl::SampleConsensusPrerejective<pcl::PointNormal, pcl::PointNormal, pcl::FPFHSignature33> search;
  search.setInputSource(model);
  search.setSourceFeatures(features_of(model, leaf, threads));
  search.setInputTarget(scene);
  search.setTargetFeatures(features_of(scene, leaf, threads));
  search.setMaximumIterations(kIterations);
  search.setNumberOfSamples(kSamples);
  search.setCorrespondenceRandomness(kRandomness);
  search.setSimilarityThreshold(static_cast<float>(similarity));
  search.setMaxCorrespondenceDistance(kInlierDistance * leaf);
  search.setInlierFraction(kInlierFraction);
  Cloud aligned;
  search.align(aligned);
  if (!search.hasConverged()) return std::nullopt;
  return search.getFinalTransformation();
}

// The scan, which is a part, onto the template. \param pose  template -> scan
Eigen::Matrix4f refined_pose(const Cloud::Ptr& model, const Cloud::Ptr& scene, double leaf,
                             const Eigen::Matrix4f& pose) {
  pcl::IterativeClosestPoint<pcl::PointNormal, pcl::PointNormal> icp;
  icp.setInputSource(scene);
  icp.setInputTarget(model);
  icp.setMaximumIterations(kIcpIterations);
  icp.setMaxCorrespondenceDistance(kInlierDistance * leaf);
  Cloud aligned;
  icp.align(aligned, pose.inverse());
  return icp.hasConverged() ? Eigen::Matrix4f(icp.getFinalTransformation().inverse()) : pose;
}

}  // namespace

std::optional<Similarity> pcl_pose(const Mesh& mesh, const PointCloud& scan, double scale, const RunContext& context,
                                   double similarity) {
  const int threads = context.threads > 0 ? context.threads : 0;  // 0: as many as there are, for PCL as well
  const double leaf = kLeaf * scale * diagonal(mesh.vertices);
  // Single precision: the scan is looked at where it is near the origin.
  const Eigen::Vector3d origin = scan.points.colwise().mean();
  const Cloud::Ptr model = sampled(mesh, scale, leaf, context);
  const Cloud::Ptr scene = scanned(scan, origin, leaf, threads);
  std::srand(static_cast<unsigned>(context.seed));  // PCL draws its samples by rand()
  const std::optional<Eigen::Matrix4f> rough = rough_pose(model, scene, leaf, threads, similarity);
  if (!rough) return std::nullopt;
  const Eigen::Matrix4d pose = refined_pose(model, scene, leaf, *rough).cast<double>();
  // Single precision leaves a rotation that is one to seven digits.
  const Eigen::Quaterniond rotation = Eigen::Quaterniond(pose.topLeftCorner<3, 3>()).normalized();
  return Similarity{scale, rotation.toRotationMatrix(), pose.topRightCorner<3, 1>() + origin};
}

}  // namespace orbifit::benchmarks
