#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/point_group.h"

#include "models/model_builder.h"
#include "models/primitives.h"

namespace orbifit {

// Closed parts for the models of the detection suite, outward-facing, their tessellation as symmetric as their shape
// wherever that is finite.

/// A group by its symbol. \pre the symbol is right
PointGroup group(const std::string& symbol);

Motion shift(double x, double y, double z);
Motion turn_x(double degrees);  ///< about the x axis
Motion turn_y(double degrees);
Motion turn_z(double degrees);

/// About z, column 0 along y: the frame of a Cnv that has a mirror through angle 0.
LocalFrame upright(double x = 0, double y = 0, double z = 0);
/// About z, column 0 along x: the frame of a Dnh with something at angle 0.
LocalFrame level(double x = 0, double y = 0, double z = 0);
/// The plane with this normal, for Cs; or any group about this axis.
LocalFrame across(const Eigen::Vector3d& axis, const Eigen::Vector3d& point = Eigen::Vector3d::Zero());

/// A closed line around the origin, counter-clockwise, that every ray from the origin meets once.
using Outline = std::vector<Eigen::Vector2d>;

/// \param radius over the angle in radians
Outline round_outline(int points, const std::function<double(double)>& radius);
/// A corner at angle 0. \param pieces of each side
Outline polygon_outline(int corners, double radius, int pieces = 1);
/// A tip at angle 0.
Outline star_outline(int tips, double outer, double inner, int pieces = 1);
Outline rectangle_outline(double half_x, double half_y, int pieces = 1);
/// Teeth with flanks; a tooth's middle at angle 0.
Outline gear_outline(int teeth, double root, double tip);
/// Teeth that rake one way: no mirror.
Outline saw_outline(int teeth, double root, double tip);

/// Where a section stands.
struct Section {
  double height = 0;
  double scale = 1;
  double degrees = 0;  ///< turned about z
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();
};

/// Skin over `levels` + 1 sections, share from 0 to 1; flat ends.
Mesh swept(const Outline& outline, int levels, const std::function<Section(double share)>& section);
Mesh extruded(const Outline& outline, double low, double high, int levels = 1);
/// From z = low to high, scaled to `taper` at the top.
Mesh tapered(const Outline& outline, double low, double high, double taper, int levels = 1);
/// Between -height / 2 and height / 2, turned evenly by `degrees` in all.
Mesh twisted(const Outline& outline, double height, double degrees, int levels);
/// Between z = -half and half around a hole.
Mesh ring_of(const Outline& outline, double hole, double half);

/// Every triangle cut into four, `times` over.
Mesh subdivided(const Mesh& mesh, int times = 1);

Mesh ball(double radius, int facets = 60);
/// A subdivided octahedron: symmetric as Oh, in the frame of the axes.
Mesh cubic_ball(double radius, int times = 3);
/// A subdivided icosahedron: symmetric as Ih.
Mesh icosahedral_ball(double radius, int times = 3);
/// Unit directions of the fivefold axes of I and Ih, both ways.
std::vector<Eigen::Vector3d> fivefold_axes();

/// About z, ends at -half and half, edges bevelled.
Mesh cylinder(double radius, double half, int facets = 60, double bevel = 0);
/// Turned about z by corners (radius, height); begins and ends on the axis.
Mesh turned_part(const std::vector<ProfilePoint>& corners, int facets = 60, int fillet_cells = 6);
/// About z.
Mesh torus(double radius, double thickness, int facets = 72, int cells = 20);
/// A round-ended cone from z = 0 to `length`.
Mesh cone(double foot, double top, double length, int facets = 24);

/// From x = `from` to `to`, cambered and twisted: no symmetry.
Mesh blade(double from, double to, double chord, double pitch_degrees, double thickness);

/// A smooth lump about the origin without any symmetry, of radius about 1.
Mesh lump(int number, int fineness = 12);

}  // namespace orbifit
