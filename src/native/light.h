// The light of every picture: a key light a little above and to the left of the eye, so that faces tilted either way
// differ, a soft sky above, and a share that falls from the eye itself.
#pragma once
#include <algorithm>
#include <cmath>

#include "camera.h"

namespace nofacet {

// Towards the key light, in eye space (right, up, forward); of unit length but for the last digit.
inline constexpr double kKeyLight[3] = {-0.29, 0.35, -0.89};
// Shares of the light: from everywhere, from the sky above, from the eye, from the key light, and its highlight.
inline constexpr double kAmbient = 0.10, kSky = 0.17, kFacing = 0.25, kKey = 0.48, kGloss = 0.10;
inline constexpr int kGlossExponent = 32;  // of the highlight's cosine; light() takes it in squarings

// Linear RGB of a face colour at a point with the unit normal `normal`, turned towards the viewer who stands in the
// unit direction `towards_eye`; all in eye space. `key`: whether the key light reaches the point.
inline void light(const Camera& camera, const double normal[3], const double towards_eye[3], const float color[4],
                  float rgb[3], bool key = true) {
  const double facing = std::min(1.0, std::fabs(Camera::dot(normal, towards_eye)));
  const double from_key = key ? std::max(0.0, Camera::dot(normal, kKeyLight)) : 0.0;
  const double world_up = camera.right[2] * normal[0] + camera.up[2] * normal[1] + camera.forward[2] * normal[2];
  const double sky = 0.5 + 0.5 * world_up;
  double highlight = 0.0;
  if (key) {
    const double half[3] = {kKeyLight[0] + towards_eye[0], kKeyLight[1] + towards_eye[1],
                            kKeyLight[2] + towards_eye[2]};
    const double gloss = std::max(0.0, Camera::dot(normal, half) / std::sqrt(Camera::dot(half, half)));
    const double gloss2 = gloss * gloss, gloss8 = gloss2 * gloss2 * gloss2 * gloss2;
    highlight = kGloss * gloss8 * gloss8 * gloss8 * gloss8;
  }
  const double diffuse = kAmbient + kSky * sky + kFacing * facing + kKey * from_key;
  for (int c = 0; c < 3; ++c) rgb[c] = float(std::min(1.0, color[c] * diffuse + highlight));
}

}  // namespace nofacet
