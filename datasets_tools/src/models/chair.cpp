#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "models/model_builder.h"
#include "models/models.h"
#include "models/primitives.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

// Axis along the leg, and the section turned so that the plane through the axis and the diagonal of x and y is a
// mirror of the leg: in a square seat it is one of the whole frame.
Matrix3d leg_frame(const Vector3d& axis) {
  const Vector3d diagonal = (Vector3d(1, 1, 0) - axis * axis.dot(Vector3d(1, 1, 0))).normalized();
  const Vector3d across = axis.cross(diagonal);
  Matrix3d frame;
  frame << (diagonal - across) / std::numbers::sqrt2, (diagonal + across) / std::numbers::sqrt2, axis;
  return frame;
}

struct Base {
  PartCopies legs, bars;
  PartFaces seat;
  Vector3d seat_middle;
};

Base build_base(ModelBuilder& builder, const ModelValues& values) {
  const int detail = values.count("detail");
  const double height = values["leg_height"];
  const double spread = values["leg_spread"];
  const double thickness = values["leg_thickness"];
  const double seat_thickness = values["seat_thickness"];
  const double half_width = values["seat_width"] / 2;
  const double half_depth = values["seat_depth"] / 2;
  Base base;
  base.seat_middle = {0, 0, height + seat_thickness / 2};
  base.seat = builder.add(
      box({half_width, half_depth, seat_thickness / 2}, {8 * detail, 8 * detail, 2}, 0.45 * seat_thickness, 3),
      {Matrix3d::Identity(), base.seat_middle});

  const double inset = 0.5 * thickness + 0.045 * values["seat_width"];
  const Vector3d upper(half_width - inset, half_depth - inset, height);
  const Vector3d lower(upper.x() + spread, upper.y() + spread, 0);
  const Vector3d along = upper - lower;
  const Mesh leg = tapered_leg(thickness, along.norm(), 0.6, detail);
  const LocalFrame leg_place{leg_frame(along.normalized()), (upper + lower) / 2};
  for (const Matrix3d& element : elements({Family::Cnv, 2})) {
    const Motion motion{element, Vector3d::Zero()};
    base.legs.faces.push_back(builder.add(moved(leg, leg_place), motion));
    base.legs.places.push_back(image(motion, leg_place));
  }

  // Bars from leg to leg at one height: one at the side and its image, one in front and its image.
  const double level = values["bar_height"];
  const Vector3d corner = lower + along * level;
  const double half_thickness = 0.26 * thickness;
  const auto bar = [&](double half_length) {
    // A little short of the legs' axes, so that bars do not share edges within a leg.
    return box({half_length - 0.3 * half_thickness, half_thickness, 1.5 * half_thickness}, {6 * detail, 2, 2},
               0.4 * half_thickness, 2);
  };
  const std::array<std::pair<double, LocalFrame>, 2> bars{
      {{corner.x(), {Matrix3d::Identity(), Vector3d(0, corner.y(), corner.z())}},
       {corner.y(), {elements({Family::Cn, 4})[1], Vector3d(corner.x(), 0, corner.z())}}}};
  for (const auto& [half_length, place] : bars) {
    for (const Matrix3d& element : elements({Family::Cn, 2})) {
      const Motion motion{element, Vector3d::Zero()};
      base.bars.faces.push_back(builder.add(moved(bar(half_length), place), motion));
      base.bars.places.push_back(image(motion, place));
    }
  }
  return base;
}

struct Back {
  PartCopies posts, slats;
  PartFaces crest;
  LocalFrame crest_place;
  LocalFrame middle;  // of posts and slats
  Vector3d step;
};

Back build_back(ModelBuilder& builder, const ModelValues& values) {
  const int detail = values.count("detail");
  const double height = values["back_height"];
  const double post = 0.8 * values["leg_thickness"];
  const double half_width = values["seat_width"] / 2 - post;
  const double tilt = values["back_tilt"] * std::numbers::pi / 180;
  const int slats = values.count("slats");
  Back back;
  // Local x to the side, y to the back, z up along the posts.
  const Matrix3d frame = axis_rotation(Vector3d::UnitX(), -tilt);
  const Vector3d foot(0, values["seat_depth"] / 2 - post, values["leg_height"] + 0.5 * values["seat_thickness"]);
  const auto at = [&](double x, double z) { return LocalFrame{frame, foot + frame * Vector3d(x, 0, z)}; };
  back.middle = at(0, height / 2);

  const Mesh post_part = box({post / 2, post / 2, height / 2}, {2 * detail, 2 * detail, 8 * detail}, 0.14 * post, 2);
  for (const double side : {-1.0, 1.0}) {
    builder.add_copy(post_part, at(side * half_width, height / 2), back.posts);
  }
  const double spacing = height / (slats + 0.6);
  back.step = frame * Vector3d(0, 0, spacing);
  const Mesh slat = box({half_width, 0.2 * post, 0.24 * spacing}, {8 * detail, 2, 2 * detail}, 0.12 * post, 2);
  for (int i = 0; i < slats; ++i) {
    builder.add_copy(slat, at(0, height / 2 + (i - 0.5 * (slats - 1)) * spacing), back.slats);
  }
  const double crest_half = 0.75 * post;
  back.crest_place = at(0, height + 0.8 * crest_half);
  back.crest =
      builder.add(box({half_width + 1.1 * post, 0.55 * post, crest_half}, {8 * detail, 2, 2 * detail}, 0.5 * post, 3),
                  back.crest_place);
  return back;
}

GeneratedModel build_chair(const ModelValues& values) {
  ModelBuilder builder;
  const Base base = build_base(builder, values);
  const Back back = build_back(builder, values);
  const PartFaces lower = joined({base.seat, joined(base.legs.faces), joined(base.bars.faces)});
  const PartFaces ladder = joined({joined(back.posts.faces), joined(back.slats.faces)});
  const PartFaces upper = joined({ladder, back.crest});

  const bool square = values["seat_width"] == values["seat_depth"];
  const int fold = square ? 4 : 2;
  builder.declare("chair", {Family::Cs, 1}, {frame_about(Vector3d::UnitX()), Vector3d::Zero()}, joined({lower, upper}));
  builder.declare("seat and legs", {Family::Cnv, fold}, {}, lower);
  builder.declare("seat", {Family::Dnh, fold}, {Matrix3d::Identity(), base.seat_middle}, base.seat);
  builder.declare_each("leg", {Family::Cnv, 4}, base.legs);
  builder.declare_each("bar", {Family::Dnh, 2}, base.bars);
  builder.declare("back", {Family::Cnv, 2}, back.middle, upper);
  builder.declare("posts and slats", {Family::Dnh, 2}, back.middle, ladder);
  builder.declare_each("post", {Family::Dnh, 4}, back.posts);
  const std::vector<PartFaces>& slats = back.slats.faces;
  for (std::size_t i = 0; i < slats.size(); ++i) {
    if (2 * i + 1 == slats.size()) continue;  // the middle one has no more than what posts and slats have
    builder.declare("slat " + std::to_string(i + 1), {Family::Dnh, 2}, back.slats.places[i], slats[i]);
  }
  builder.declare("crest", {Family::Dnh, 2}, back.crest_place, back.crest);
  if (slats.size() >= 3) builder.declare_row("slats", back.step, slats);
  return builder.finish();
}

}  // namespace

ModelDefinition chair_model() {
  return {
      {"chair",
       "a chair with splayed legs, cross bars and a ladder back",
       {{"leg_height", 0.43, 0.2, 0.8, false, "floor to seat, m"},
        {"leg_spread", 0.03, 0, 0.12, false, "how far each foot stands outwards of its upper end, in x and in y, m"},
        {"leg_thickness", 0.055, 0.02, 0.07, false, "m"},
        {"bar_height", 0.35, 0.1, 0.8, false, "of the cross bars, as a fraction of the legs' height"},
        {"seat_width", 0.44, 0.3, 0.8, false, "m"},
        {"seat_depth", 0.44, 0.3, 0.8, false, "m; C4v below where it equals the width, else C2v"},
        {"seat_thickness", 0.036, 0.015, 0.06, false, "m"},
        {"back_height", 0.44, 0.2, 0.9, false, "of the posts, m"},
        {"back_tilt", 9, 0, 25, false, "backwards, degrees"},
        {"slats", 4, 1, 12, true, "in the back"},
        {"detail", 2, 1, 8, true, "fineness of the mesh"}}},
      build_chair};
}

}  // namespace orbifit
