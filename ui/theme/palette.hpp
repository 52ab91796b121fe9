#pragma once

#include <array>
#include <cstdint>

namespace stillpoint {

/// An sRGB colour.
struct Rgb {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Rgb&) const = default;
};

/// The eight colours of Okabe and Ito ("Color Universal Design", 2008), which people with any of the common
/// colour vision deficiencies tell apart.
namespace okabe_ito {
inline constexpr Rgb kBlack{0x00, 0x00, 0x00};
inline constexpr Rgb kOrange{0xE6, 0x9F, 0x00};
inline constexpr Rgb kSkyBlue{0x56, 0xB4, 0xE9};
inline constexpr Rgb kGreen{0x00, 0x9E, 0x73};
inline constexpr Rgb kYellow{0xF0, 0xE4, 0x42};
inline constexpr Rgb kBlue{0x00, 0x72, 0xB2};
inline constexpr Rgb kVermillion{0xD5, 0x5E, 0x00};
inline constexpr Rgb kPurple{0xCC, 0x79, 0xA7};
}  // namespace okabe_ito

enum class ThemeName { kDark, kLight };

/// What a colour stands for, the same in every panel. Panels ask for a role, never for a colour.
enum class Role {
  kInlier,
  kOutlier,
  kKept,
  kRemoved,
  kForward,
  kBackward,
  kUnion,
  kEstimate,
  kGroundTruth,
  kBaseline,
  kMapPoint,
  kCursor,
  kWarning,
  kCount
};

/// The colour of a role. The light theme darkens those that would fade on white.
[[nodiscard]] constexpr Rgb role_colour(Role role, ThemeName theme) {
  const bool dark = theme == ThemeName::kDark;
  switch (role) {
    case Role::kInlier:
    case Role::kKept:
      return okabe_ito::kGreen;
    case Role::kOutlier:
    case Role::kRemoved:
      return okabe_ito::kVermillion;
    case Role::kForward:
      return okabe_ito::kOrange;
    case Role::kBackward:
    case Role::kEstimate:
      return dark ? okabe_ito::kSkyBlue : okabe_ito::kBlue;
    case Role::kUnion:
      return okabe_ito::kPurple;
    case Role::kGroundTruth:
      return dark ? Rgb{0xDD, 0xE1, 0xE7} : Rgb{0x2B, 0x2F, 0x36};
    case Role::kBaseline:
      return okabe_ito::kOrange;
    case Role::kMapPoint:
      return dark ? Rgb{0x8B, 0x97, 0xA8} : Rgb{0x6B, 0x77, 0x88};
    case Role::kCursor:
      return dark ? okabe_ito::kYellow : Rgb{0xA8, 0x3F, 0x7C};
    case Role::kWarning:
      return dark ? okabe_ito::kYellow : okabe_ito::kVermillion;
    case Role::kCount:
      break;
  }
  return okabe_ito::kBlack;
}

/// Colours for series that have no role, in the order they are told apart best.
inline constexpr std::array<Rgb, 6> kSeriesColours = {okabe_ito::kSkyBlue, okabe_ito::kOrange,
                                                      okabe_ito::kGreen,   okabe_ito::kVermillion,
                                                      okabe_ito::kPurple,  okabe_ito::kYellow};

}  // namespace stillpoint
