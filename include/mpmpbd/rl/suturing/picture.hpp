// What a camera sees of a stitch, as an observation; and how camera and colours differ between
// episodes.
#pragma once

#include <algorithm>

#include <mpmpbd/catalog/suturing_picture.hpp>
#include <mpmpbd/rl/suturing/config.hpp>
#include <mpmpbd/rl/suturing/progress.hpp>

namespace mpmpbd::rl {

namespace stitch {
struct EyeShift : Field<"eye_shift", "m", Vector, Environments> {};
struct Tint : Field<"tint", "1", Numbers<3>, Environments> {
};  // factors on the tissue's red, green, blue
}  // namespace stitch

// The place of the camera, evenly in a cube, and the tissue's colour, each channel times a factor.
struct RandomLook {
  using Role = role::Randomisation;
  static constexpr FixedString name = "RandomLook";
  using Reads = Fields<>;
  using Writes = Fields<stitch::EyeShift, stitch::Tint>;
  template <class T> struct Parameters {
    T shift;   // half the edge of the cube [m]
    T factor;  // at most; at least its inverse
  };
  static constexpr ParameterInfo parameter_info[] = {bound::not_negative("shift", "m"),
                                                     bound::positive("factor", "1")};
  template <class Env, class Ctx>
  MPMPBD_HD static void apply(Env const& env, Ctx const& context, Random& random) {
    using T = typename Env::Scalar;
    auto const& k = context.template of<RandomLook>();
    Vec3<T> shift, tint;
    for (int a = 0; a < 3; ++a) shift[a] = T(random.between(-k.shift, k.shift));
    for (int a = 0; a < 3; ++a) tint[a] = T(random.factor(1 / k.factor, k.factor));
    env.template set<stitch::EyeShift>(0, shift);
    env.template set<stitch::Tint>(0, tint);
  }
};

// Draws environments, each lane of the back end with a canvas of its own.
class StitchCamera {
 public:
  StitchCamera(SuturingTaskConfig const& c, int lanes)
      : picture_(c.scene),
        rest_(surface_sheet(c.scene)),
        size_(c.picture),
        canvases_(static_cast<std::size_t>(lanes)) {}

  template <class Env, class Ctx>
  void draw(Env const& env, Ctx const& context, int lane, std::uint8_t* out) {
    auto& with = canvases_[static_cast<std::size_t>(lane)];
    with.moment.take(env);
    picture_.draw(with.canvas, with.moment, look(env, context), size_.width, size_.height,
                  with.image);
    std::copy(with.image.rgb.begin(), with.image.rgb.end(), out);
  }

 private:
  struct Lane {
    suturing::Canvas canvas;
    suturing::Moment moment;
    render::Image image;
  };

  template <class Env, class Ctx> suturing::Look look(Env const& env, Ctx const& context) const {
    auto look = picture_.look();
    look.eye += cast<float>(env.template get<stitch::EyeShift>(0));
    look.tint = cast<float>(env.template get<stitch::Tint>(0));
    auto const arc = ArcNeedle::arc(context.template of<ArcNeedle>());
    look.needle.radius = static_cast<float>(arc.radius);
    for (auto which : {stitch::entry, stitch::exit}) look.markers[which] = ink(env, which);
    return look;
  }
  // Where a marker is painted: on the tissue at rest.
  template <class Env> Vec3<float> ink(Env const& env, stitch::Marker which) const {
    auto const& markers = env.template domain<Markers>();
    auto const mark = marker::load(markers.view, markers.first + which);
    return position(sheet_of(rest_), SurfaceMark<float>{mark.triangle, cast<float>(mark.weights)});
  }
  static SheetMesh<float> surface_sheet(SuturingConfig const& c) {
    auto const mesh = suturing::surface_mesh(c);
    SheetMesh<float> rest{{}, mesh.triangles};
    for (auto const& x : mesh.positions) rest.positions.push_back(cast<float>(x));
    return rest;
  }

  suturing::StitchPicture picture_;
  SheetMesh<float> rest_;
  PictureConfig size_;
  std::vector<Lane> canvases_;
};

// An RGB picture, (height, width, 3), 8 bits each, sRGB. Goes with RandomLook.
struct CameraPicture {
  using Role = role::Observation;
  static constexpr FixedString name = "picture";
  using Reads =
      union_t<StitchProgress::Reads, Fields<bead::Position, stitch::EyeShift, stitch::Tint>>;
  using Writes = Fields<>;
  using Element = std::uint8_t;
  using Viewer = StitchCamera;
  static std::vector<std::int64_t> shape(SuturingTaskConfig const& c) {
    return {c.picture.height, c.picture.width, 3};
  }
};

}  // namespace mpmpbd::rl
