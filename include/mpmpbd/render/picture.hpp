// What a pixel needs to know of everything that is pictured, and the light that reaches it.
//
// Plain data behind pointers and no std:: in the functions, so that a kernel may run the same text.
#pragma once

#include <mpmpbd/render/facet.hpp>
#include <mpmpbd/render/marker.hpp>
#include <mpmpbd/render/mesh.hpp>
#include <mpmpbd/render/shadow.hpp>

namespace mpmpbd::render {

// A mesh with its finish and ink, as the pixels see it.
struct Subject {
  Vec3<float> const* view;      // positions in view coordinates [m], (vertex, 3)
  Vec3<float> const* normals;   // in the world, unit, (vertex, 3)
  Vec3<float> const* material;  // positions at rest [m], (vertex, 3)
  Vec3<float> const* colours;   // linear RGB, (vertex, 3), or null
  Triangle const* triangles;    // (triangle, 3)
  Marker const* markers;        // (marker)
  int marker_count;
  bool closed;  // triangles seen from behind are hidden by others
  int first;    // number of its first triangle among those of all subjects
  Finish finish;
};

struct Picture {
  Camera camera;
  Studio studio;
  Subject const* subjects;  // (subject), in order of their first triangles
  int subject_count;
  ShadowView on_tissue;  // shadows of the opaque subjects on the translucent ones
  ShadowView on_ground;  // shadows of all on the ground
  ShadowView contact;    // darkness under all of them
};

inline constexpr int none = -1;
inline constexpr float infinitely_far = __builtin_huge_valf();

MPMPBD_HD inline Subject const& subject_of(Picture const& picture, int triangle) {
  int k = picture.subject_count - 1;
  while (k > 0 && picture.subjects[k].first > triangle) --k;
  return picture.subjects[k];
}

// Whether the normal is continuous from one triangle to the other: they share a vertex, and edges
// that are meant to be sharp share none.
MPMPBD_HD inline bool smooth_across(Picture const& picture, int a, int b) {
  if (a == b) return true;
  if (a == none || b == none) return false;
  Subject const& subject = subject_of(picture, a);
  if (&subject != &subject_of(picture, b)) return false;
  Triangle const& s = subject.triangles[a - subject.first];
  Triangle const& t = subject.triangles[b - subject.first];
  for (int i = 0; i < 3; ++i)
    if (s[i] == t[0] || s[i] == t[1] || s[i] == t[2]) return true;
  return false;
}

// A ray from the eye: in view coordinates with forward = 1, and in the world with length 1.
struct Ray {
  Vec3<float> view;
  Vec3<float> world;
  float length;  // of `view`: distance along the ray per metre forward
};
MPMPBD_HD inline Ray eye_ray(Camera const& camera, float column, float row) {
  Ray ray;
  ray.view = pixel_ray(camera, column, row);
  ray.length = sqrt(dot(ray.view, ray.view));
  ray.world =
      (1.0f / ray.length) * (ray.view[0] * camera.right + ray.view[1] * camera.up + camera.forward);
  return ray;
}

// Where a ray meets a triangle.
struct Surface {
  Vec3<float> light;  // sent to the eye, linear RGB
  float distance;     // along the ray [m]
  float facing;       // cosine between normal and line of sight
};

MPMPBD_HD inline Vec3<float> blend(Vec3<float> const* of, Triangle const& t, Vec3<float> const& w) {
  Vec3<float> const& a = of[t[0]];
  Vec3<float> const& b = of[t[1]];
  Vec3<float> const& c = of[t[2]];
  return vec(w[0] * a[0] + w[1] * b[0] + w[2] * c[0], w[0] * a[1] + w[1] * b[1] + w[2] * c[1],
             w[0] * a[2] + w[1] * b[2] + w[2] * c[2]);
}

// Natural unevenness of colour and relief at the material position x; `pixel` is the size of a pixel
// there [m].
MPMPBD_HD inline void roughen(Finish const& finish, Vec3<float> const& x, float pixel,
                              Fragment& f) {
  float const scale = 1.0f / finish.grain;
  Noise n = noise(scale * x);
  n.value *= 0.65f;
  // What is finer than a pixel would only flicker, so it fades out before.
  float const seen = clamp(0.25f * finish.grain / pixel - 2.5f, 0.0f, 1.0f);
  if (seen > 0.0f) {
    Noise const fine = noise(2.7f * scale * x);
    n.value += 0.35f * seen * fine.value;
    n.gradient += seen * fine.gradient;
    f.normal =
        unit(f.normal - (seen * finish.bump) * (n.gradient - dot(n.gradient, f.normal) * f.normal));
  }
  // Blood is what is uneven: green and blue change more than red.
  float const m = finish.mottle * n.value;
  f.albedo = times(f.albedo, vec(1.0f + 0.35f * m, 1.0f + m, 1.0f + m));
}

// What the surface is like at the weights w of a triangle's corners.
MPMPBD_HD inline void paint(Subject const& subject, Triangle const& t, Vec3<float> const& w,
                            float pixel, Fragment& f) {
  Finish const& finish = subject.finish;
  f.albedo = finish.colour;
  if (subject.colours != nullptr) f.albedo = times(f.albedo, blend(subject.colours, t, w));
  if (finish.mottle <= 0.0f && finish.grid <= 0.0f && subject.marker_count == 0) return;
  Vec3<float> const x = blend(subject.material, t, w);
  if (finish.mottle > 0.0f) roughen(finish, x, pixel, f);
  if (finish.grid > 0.0f)
    f.albedo = (1.0f - 0.35f * grid_coverage(finish.grid, x, f.normal, pixel)) * f.albedo;
  for (int k = 0; k < subject.marker_count; ++k)
    f.albedo = mix(f.albedo, subject.markers[k].colour, coverage(subject.markers[k], x, pixel));
}

MPMPBD_HD inline Surface surface_at(Picture const& picture, int triangle, Ray const& ray) {
  Subject const& subject = subject_of(picture, triangle);
  Triangle const& t = subject.triangles[triangle - subject.first];
  Facet facet{};
  make_facet(subject.view[t[0]], subject.view[t[1]], subject.view[t[2]], facet);
  Vec3<float> w = weights(facet, ray.view);
  // The mean of a pixel's samples may lie beside the triangle, but its colour should not.
  for (int i = 0; i < 3; ++i) w[i] = clamp(w[i], 0.0f, 1.0f);
  w = (1.0f / (w[0] + w[1] + w[2])) * w;
  float const forward = blend(subject.view, t, w)[2];

  Fragment f;
  f.to_eye = -ray.world;
  f.normal = unit(blend(subject.normals, t, w));
  if (!facet.front) f.normal = -f.normal;  // a sheet seen from behind
  // A smooth normal at a silhouette may point away from the eye: it is bent back to the horizon.
  float const facing = dot(f.normal, f.to_eye);
  if (facing < 0.0f) f.normal = unit(f.normal - facing * f.to_eye);
  paint(subject, t, w, forward / picture.camera.focal, f);
  f.lit = 1.0f;
  if (translucent(subject.finish)) {
    Vec3<float> const x = picture.camera.eye + (forward * ray.length) * ray.world;
    f.lit = 1.0f - 0.8f * shadow(picture.on_tissue, x);
  }
  return {shade(subject.finish, picture.studio, f), forward * ray.length, max(facing, 0.0f)};
}

// Ground or sky along a ray that meets no subject; `distance` [m] is infinite for the sky.
MPMPBD_HD inline Vec3<float> surroundings_at(Picture const& picture, Ray const& ray,
                                             float& distance) {
  Studio const& s = picture.studio;
  float const climb = dot(ray.world, s.up);
  float const height = dot(picture.camera.eye, s.up) - s.ground_height;
  distance = infinitely_far;
  Vec3<float> const sky = background(s, ray.world);
  if (!s.ground || climb * height >= 0.0f) return sky;
  distance = -height / climb;
  Vec3<float> const x = picture.camera.eye + distance * ray.world;
  Vec3<float> const from_centre = x - s.centre;
  Vec3<float> const flat = from_centre - dot(from_centre, s.up) * s.up;
  float const key = 1.0f - 0.75f * shadow(picture.on_ground, x);
  float const open = 1.0f - 0.65f * shadow(picture.contact, x);
  Vec3<float> const light = (max(dot(s.up, s.key), 0.0f) * key) * s.key_colour +
                            (max(dot(s.up, s.fill), 0.0f) * open) * s.fill_colour + open * s.sky;
  return mix(times(s.ground_colour, light), sky,
             smoothstep(1.3f * s.reach, 5.0f * s.reach, norm(flat)));
}

// The light that arrives along a ray which meets `opaque` first of the opaque triangles and, in front
// of it, `veil` first of the translucent ones (`none`: does not meet any).
MPMPBD_HD inline Vec3<float> light_along(Picture const& picture, int opaque, int veil,
                                         Ray const& ray) {
  Vec3<float> behind{};
  float distance = infinitely_far;
  if (opaque != none) {
    Surface const inner = surface_at(picture, opaque, ray);
    behind = inner.light;
    distance = inner.distance;
  }
  if (veil == none) return opaque == none ? surroundings_at(picture, ray, distance) : behind;
  Surface const skin = surface_at(picture, veil, ray);
  if (opaque == none) return skin.light;
  // Beer and Lambert: what is behind fades with the way of its light through the tissue, and is lit by
  // light that came about as far.
  Finish const& finish = subject_of(picture, veil).finish;
  float const enters = (1.0f - finish.cloud) * (1.0f - fresnel(finish.coat, skin.facing));
  Vec3<float> light;
  for (int c = 0; c < 3; ++c) {
    float const left = exp(-max(distance - skin.distance, 0.0f) / finish.free_path[c]);
    light[c] = skin.light[c] + enters * left * (left * behind[c] - skin.light[c]);
  }
  return light;
}

}  // namespace mpmpbd::render
