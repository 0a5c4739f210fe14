// From a fragment of surface to the light that it sends to the eye.
//
// Diffuse light wraps around edges per colour, which stands in for scattering under the skin. The
// highlight is the Trowbridge-Reitz (GGX) distribution with Karis' approximation of the visibility
// term (SIGGRAPH course on physically based shading, 2013); Fresnel after Schlick (1994).
#pragma once

#include <mpmpbd/render/finish.hpp>
#include <mpmpbd/render/studio.hpp>

namespace mpmpbd::render {

struct Fragment {
  Vec3<float> normal;  // unit, on the side of the eye
  Vec3<float> to_eye;  // unit
  Vec3<float> albedo;  // the finish's colour after vertex colour, mottle and ink, linear RGB
  float lit;           // part of the key light that arrives, 0 to 1
};

MPMPBD_HD inline Vec3<float> times(Vec3<float> const& a, Vec3<float> const& b) {
  return vec(a[0] * b[0], a[1] * b[1], a[2] * b[2]);
}
MPMPBD_HD inline Vec3<float> mix(Vec3<float> const& a, Vec3<float> const& b, float s) {
  return vec(a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), a[2] + s * (b[2] - a[2]));
}
MPMPBD_HD inline float smoothstep(float low, float high, float x) {
  float const s = clamp((x - low) / (high - low), 0.0f, 1.0f);
  return s * s * (3.0f - 2.0f * s);
}
MPMPBD_HD inline Vec3<float> unit(Vec3<float> const& a) {
  float const s = 1.0f / sqrt(max(dot(a, a), 1e-30f));
  return vec(s * a[0], s * a[1], s * a[2]);
}

// Reflectance at an angle with cosine c, from the reflectance seen straight on.
MPMPBD_HD inline float fresnel(float straight, float c) {
  float const s = clamp(1.0f - c, 0.0f, 1.0f);
  return straight + (1.0f - straight) * square(s * s) * s;
}

// The highlight of a light in direction l.
MPMPBD_HD inline float highlight(Fragment const& f, Vec3<float> const& l, float coat,
                                 float roughness) {
  Vec3<float> const h = unit(l + f.to_eye);
  float const n_h = max(dot(f.normal, h), 0.0f);
  float const l_h = max(dot(l, h), 0.0f);
  float const a2 = square(roughness * roughness);
  float const spread = n_h * n_h * (a2 - 1.0f) + 1.0f;
  float const distribution = a2 / (spread * spread);
  return fresnel(coat, l_h) * distribution / (4.0f * max(l_h * l_h, 0.1f) * (roughness + 0.5f)) *
         clamp(4.0f * dot(f.normal, l), 0.0f, 1.0f);
}

// Diffuse light of one lamp: cosine, stretched around the terminator by w and scaled to the same total.
MPMPBD_HD inline Vec3<float> wrapped(float cosine, Vec3<float> const& w) {
  Vec3<float> r;
  for (int c = 0; c < 3; ++c) r[c] = max(cosine + w[c], 0.0f) / square(1.0f + w[c]);
  return r;
}

// Light from the whole surroundings onto a surface that faces n.
MPMPBD_HD inline Vec3<float> ambient(Studio const& s, Vec3<float> const& n) {
  return mix(s.bounce, s.sky, 0.5f + 0.5f * dot(n, s.up));
}

// What a mirror sees in direction r: bright sky, dark horizon, light ground and two soft boxes.
MPMPBD_HD inline Vec3<float> surroundings(Studio const& s, Vec3<float> const& r) {
  float const height = dot(r, s.up);
  Vec3<float> const above =
      mix(0.16f * s.horizon, 1.05f * s.horizon, smoothstep(-0.02f, 0.75f, height));
  Vec3<float> const below =
      mix(0.16f * s.horizon, 0.55f * s.ground_colour, smoothstep(0.05f, 0.9f, -height));
  Vec3<float> const base = height > 0.0f ? above : below;
  float const key_box = smoothstep(0.80f, 0.93f, dot(r, s.key));
  float const fill_box = smoothstep(0.82f, 0.92f, dot(r, s.fill));
  return base + (1.9f * key_box) * s.key_colour + (3.0f * fill_box) * s.fill_colour;
}

MPMPBD_HD inline Vec3<float> shade_metal(Finish const& finish, Studio const& s, Fragment const& f) {
  float const c = max(dot(f.normal, f.to_eye), 0.0f);
  Vec3<float> const mirrored = 2.0f * c * f.normal - f.to_eye;
  Vec3<float> const tint = mix(f.albedo, vec(1.0f, 1.0f, 1.0f), fresnel(0.0f, c));
  // A little of the broad light stands in for the scratches of real polish.
  Vec3<float> const light = 0.82f * surroundings(s, mirrored) + 0.25f * ambient(s, f.normal);
  return times(tint, light) +
         (0.35f * f.lit * highlight(f, s.key, finish.coat, finish.roughness)) * s.key_colour;
}

MPMPBD_HD inline Vec3<float> shade_diffuse(Finish const& finish, Studio const& s,
                                           Fragment const& f) {
  Vec3<float> const key = f.lit * times(s.key_colour, wrapped(dot(f.normal, s.key), finish.wrap));
  Vec3<float> const fill = times(s.fill_colour, wrapped(dot(f.normal, s.fill), finish.wrap));
  float const c = max(dot(f.normal, f.to_eye), 0.0f);
  float const gloss = f.lit * highlight(f, s.key, finish.coat, finish.roughness);
  float const sheen = fresnel(finish.coat, c) * (1.0f - finish.roughness);
  Vec3<float> const mirrored = 2.0f * c * f.normal - f.to_eye;
  return times(f.albedo, key + fill + ambient(s, f.normal)) + gloss * s.key_colour +
         sheen * surroundings(s, mirrored);
}

MPMPBD_HD inline Vec3<float> shade(Finish const& finish, Studio const& s, Fragment const& f) {
  return finish.metal > 0.5f ? shade_metal(finish, s, f) : shade_diffuse(finish, s, f);
}

// The background along a unit direction.
MPMPBD_HD inline Vec3<float> background(Studio const& s, Vec3<float> const& d) {
  return mix(s.horizon, s.zenith, smoothstep(-0.05f, 0.7f, dot(d, s.up)));
}

// Linear light to the code value 0..255 of a screen: faithful up to 0.75, then a soft shoulder that
// never quite reaches white; then the sRGB curve.
MPMPBD_HD inline float expose(float light) {
  float const knee = 0.75f;
  float const over = max(light - knee, 0.0f) / (1.0f - knee);
  return min(light, knee) + (1.0f - knee) * over / (1.0f + over);
}
MPMPBD_HD inline float srgb(float light) {
  return light <= 0.0031308f ? 12.92f * light : 1.055f * pow(light, 1.0f / 2.4f) - 0.055f;
}

// Unevenness of natural surfaces: smooth noise of grain 1, its value from -1 to 1 and its gradient.
struct Noise {
  float value;
  Vec3<float> gradient;
};

// A number from -1 to 1 that looks random, from the mixed coordinates of a lattice point.
MPMPBD_HD inline float lattice_value(unsigned h) {
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h ^= h >> 12;
  return float(int(h & 0xffffu)) * (2.0f / 65535.0f) - 1.0f;
}

MPMPBD_HD inline Noise noise(Vec3<float> const& x) {
  constexpr unsigned prime[3] = {0x8da6b343u, 0xd8163841u, 0xcb1ab31fu};
  unsigned mixed[3][2];  // of the lattice coordinates below and above
  float s[3];            // smooth position in the cell
  float slope[3];        // its derivative
  for (int i = 0; i < 3; ++i) {
    // Rounded down without floor(), which is a call on machines without SSE4.
    int const truncated = int(x[i]);
    int const cell = float(truncated) > x[i] ? truncated - 1 : truncated;
    mixed[i][0] = unsigned(cell) * prime[i];
    mixed[i][1] = mixed[i][0] + prime[i];
    float const t = x[i] - float(cell);
    s[i] = t * t * (3.0f - 2.0f * t);
    slope[i] = 6.0f * t * (1.0f - t);
  }
  // Interpolated along x, then y, then z; derivatives go through the same steps.
  float value[2], dx[2], dy[2];
  for (int k = 0; k < 2; ++k) {
    float line[2], change[2];
    for (int j = 0; j < 2; ++j) {
      unsigned const row = mixed[1][j] ^ mixed[2][k];
      float const a = lattice_value(mixed[0][0] ^ row);
      change[j] = lattice_value(mixed[0][1] ^ row) - a;
      line[j] = a + s[0] * change[j];
    }
    value[k] = line[0] + s[1] * (line[1] - line[0]);
    dx[k] = change[0] + s[1] * (change[1] - change[0]);
    dy[k] = line[1] - line[0];
  }
  return {value[0] + s[2] * (value[1] - value[0]),
          vec(slope[0] * (dx[0] + s[2] * (dx[1] - dx[0])),
              slope[1] * (dy[0] + s[2] * (dy[1] - dy[0])), slope[2] * (value[1] - value[0]))};
}

}  // namespace mpmpbd::render
