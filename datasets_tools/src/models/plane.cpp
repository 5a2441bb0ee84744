#include <cmath>
#include <numbers>

#include "models/model_builder.h"
#include "models/models.h"
#include "models/primitives.h"
#include "models/shapes.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

// x forwards, y to the left, z up; metres. The propeller's shaft is the x axis, and its disc the plane x = kNose.
constexpr double kNose = 2.6;

Mesh fuselage(double length, int detail) {
  const double tail = kNose - length;
  const Curve meridian(trace_profile({{0, kNose, 0, 1},
                                      {0.5, kNose, 0.22, 1},
                                      {0.72, kNose - 0.3 * length, 1.6, 1},
                                      {0.1, tail, 0.09, 1},
                                      {0, tail, 0, 1}},
                                     24, false));
  return capped_skin({6, 2 * detail, 32 * detail}, [&](double share, double cosine, double sine) {
    const Vector3d place = meridian(share);
    const double back = (kNose - place.z()) / length;
    // Taller than wide behind the cowling, and rising to the tail.
    const double height = smooth_table({{0, 1.04}, {0.35, 1.22}, {0.7, 1.3}, {1, 1.6}}, back);
    const double lift = smooth_table({{0.25, 0}, {1, 0.22}}, back);
    const double exponent = smooth_table({{0, 2}, {0.3, 2.4}, {0.8, 2.1}}, back);
    const Eigen::Vector2d around = place.x() * rounded_square(cosine, sine, exponent);
    return Vector3d(place.z(), around.y(), height * around.x() + lift);
  });
}

// Where a direction around an aerofoil lies along its chord, from 0 at the round nose, where points crowd, to 1.
double along_chord(double cosine, double sine) {
  return 1 - std::cos(0.5 * std::atan2(std::abs(sine), cosine));
}

// Half the thickness of an aerofoil over its chord (the NACA four-digit series), of its upper or lower side.
double aerofoil(double chord_share, double side) {
  if (side == 0) return 0;
  return std::copysign(1.1, side) *
         (0.2969 * std::sqrt(chord_share) - 0.126 * chord_share - 0.3516 * chord_share * chord_share +
          0.2843 * std::pow(chord_share, 3) - 0.1036 * std::pow(chord_share, 4)) /
         0.2;
}

struct Wing {
  double span = 0;       // of both sides, or twice a fin's height
  double root = 0;       // chord
  double taper = 0;      // chord at the tip over that at the root
  double sweep = 0;      // how far the tip's quarter chord lies behind the root's
  double rise = 0;       // of the tip
  double thickness = 0;  // over the chord
};

// A section's point: `out` from -1 to 1 along the span, `round` from 0 at a tip's end to 1 where its rounding ends.
Vector3d wing_point(const Wing& wing, double out, double round, double cosine, double sine) {
  const double side = std::abs(out);
  const double chord = wing.root * (1 - (1 - wing.taper) * std::pow(side, 1.5)) * round;
  const double along = along_chord(cosine, sine);
  const double camber = 0.08 * chord * along * (1 - along);
  const double upper = wing.thickness * chord * aerofoil(along, sine);
  // Smooth at the root, where the two sides meet.
  const double bend = std::sqrt(side * side + 0.01) - 0.1;
  return {-wing.sweep * side + chord * (0.25 - along) - (1 - round) * 0.12 * wing.root, 0.5 * wing.span * out,
          upper + camber + wing.rise * bend};
}

Mesh wing_part(const Wing& wing, const SkinCounts& counts) {
  const double tip = 0.5 * wing.root * wing.taper;
  const double half = 0.5 * wing.span;
  const Curve outline(trace_profile(
      {{0, -half, 0, 1}, {tip, -half, 0.995 * tip, 1}, {tip, half, 0.995 * tip, 1}, {0, half, 0, 1}}, 24, false));
  return capped_skin(counts, [&](double share, double cosine, double sine) {
    const Vector3d place = outline(share);
    return wing_point(wing, place.z() / half, place.x() / tip, cosine, sine);
  });
}

// A fin stands on its root, which is rounded into the fuselage: a wing's one half, turned up, its section without
// camber.
Mesh fin_part(const Wing& wing, const SkinCounts& counts) {
  const double tip = 0.5 * wing.root * wing.taper;
  const double root = 0.5 * wing.root;
  const double height = 0.5 * wing.span;
  constexpr double kRootDepth = 0.2;
  const Curve outline(trace_profile({{0, -root, 0, 1},
                                     {root, -root, 0.98 * root, 1},
                                     {root, 0, 0, 1},
                                     {tip, height, 0.9 * tip, 1},
                                     {0, height, 0, 1}},
                                    24, false));
  return capped_skin(counts, [&](double share, double cosine, double sine) {
    const Vector3d place = outline(share);
    const double up = place.z() / height;
    const double chord = 2 * place.x();
    const double along = along_chord(cosine, sine);
    return Vector3d(-wing.sweep * std::max(0.0, up) + chord * (0.5 - along),
                    wing.thickness * chord * aerofoil(along, sine),
                    place.z() < 0 ? kRootDepth * place.z() / root : place.z());
  });
}

Mesh canopy(int detail) {
  return capped_skin({6, detail, 3 * detail}, [&](double share, double cosine, double sine) {
    const double angle = std::numbers::pi * share;
    const double wide = std::pow(std::sin(angle), 0.8);
    const double height = smooth_table({{0, 0.3}, {0.3, 0.58}, {1, 0.3}}, share);
    return Vector3d(0.95 * std::cos(angle), 0.36 * wide * sine, height * wide * (cosine > 0 ? 1 : 0.5) * cosine);
  });
}

// About x; a propeller_blade's root is broad and its section a lens, arched to the front, so that the blades have no
// mirror plane across the shaft but one through each.
Mesh propeller_blade(double length, int detail) {
  const Curve outline(trace_profile(
      {{0, 0, 0, 1}, {0.07, 0, 0.02, 1}, {0.15, 0.62 * length, 0.5, 1}, {0.1, length, 0.09, 1}, {0, length, 0, 1}}, 24,
      false));
  return capped_skin({4, detail, 5 * detail}, [&](double share, double cosine, double sine) {
    const Vector3d place = outline(share);
    const double out = place.z() / length;
    const double thin = 0.45 - 0.3 * std::min(1.0, 1.6 * out);
    return Vector3d(thin * place.x() * sine + 0.06 * length * std::sin(std::numbers::pi * out), place.x() * cosine,
                    place.z());
  });
}

// Three lobes, one for each propeller_blade: no rounder than the propeller.
Mesh spinner(int detail) {
  return turned(
      {6, detail, detail},
      trace_profile(
          {{0, 0.62, 0, 1}, {0.16, 0.5, 0.2, 1}, {0.33, 0.02, 0.02, 1}, {0.3, -0.06, 0.02, 1}, {0, -0.06, 0, 1}}, 16,
          false),
      [](double, double cosine, double sine) { return 1 - 0.06 * cosine_of_multiple(3, cosine, sine); });
}

GeneratedModel build_plane(const ModelValues& values) {
  const int detail = values.count("detail");
  const double span = values["span"];
  const double length = values["length"];
  const double tail = kNose - length;
  const auto at = [](double x, double y, double z) { return Motion{Matrix3d::Identity(), Vector3d(x, y, z)}; };
  ModelBuilder builder(0);
  std::vector<PartFaces> parts;
  parts.push_back(builder.add(fuselage(length, detail)));
  const Wing wing{span, 2.1, 0.5, values["sweep"], values["dihedral"], 0.13};
  parts.push_back(builder.add(wing_part(wing, {6, 2 * detail, 34 * detail}), at(0.7, 0, -0.38)));
  const Wing stabiliser{0.36 * span, 0.95, 0.6, 0.25, 0.05, 0.1};
  parts.push_back(builder.add(wing_part(stabiliser, {6, detail, 14 * detail}), at(tail + 0.62, 0, 0.27)));
  const Wing fin{2 * values["fin"], 1.3, 0.45, 0.45, 0, 0.1};
  parts.push_back(builder.add(fin_part(fin, {6, detail, 5 * detail}), at(tail + 0.6, 0, 0.2)));
  parts.push_back(builder.add(canopy(detail), at(0.1, 0, 0.62)));

  // The propeller is made about z and then turned; a propeller_blade stands in the mirror plane.
  Matrix3d forward;
  forward << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  std::vector<PartFaces> propeller;
  propeller.push_back(builder.add(spinner(detail), {forward, Vector3d(kNose, 0, 0)}));
  Matrix3d turned_frame;
  turned_frame << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  const LocalFrame shaft{turned_frame, Vector3d(kNose, 0, 0)};  // columns: y (a mirror's normal), z, x
  for (const Matrix3d& turn : elements({Family::Cn, 3}, turned_frame)) {
    propeller.push_back(
        builder.add(propeller_blade(values["propeller"], detail), {turn, Vector3d(kNose + 0.12, 0, 0)}));
  }
  parts.push_back(joined(propeller));
  builder.declare("plane", {Family::Cs, 1}, {frame_about(Vector3d::UnitY()), Vector3d::Zero()}, joined(parts));
  builder.declare("propeller", {Family::Cnv, 3}, shaft, parts.back());
  return builder.finish();
}

}  // namespace

ModelDefinition plane_model() {
  return {{"plane",
           "a propeller aeroplane: a mirror plane, and a propeller of three blades within it",
           {{"span", 10, 7, 14, false, "m"},
            {"length", 7.4, 6, 10, false, "of the fuselage, m"},
            {"sweep", 0.35, 0, 2, false, "how far the wings' tips lie behind their roots, m"},
            {"dihedral", 0.5, 0, 1.5, false, "how far the wings' tips lie above their roots, m"},
            {"fin", 1.35, 0.8, 2, false, "height of the fin, m"},
            {"propeller", 1.25, 0.8, 1.6, false, "length of a propeller_blade, m"},
            {"detail", 4, 1, 110, true, "fineness of the mesh: about 1000 detail^2 vertices"}}},
          build_plane};
}

}  // namespace orbifit
