#pragma once

#include <string>
#include <vector>

namespace stillpoint {

/// The bytes of a text in base64, up to the first letter that is none of it.
inline std::vector<unsigned char> from_base64(const std::string& text) {
  static const std::string kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned char> bytes;
  unsigned held = 0;
  int bits = 0;
  for (const char letter : text) {
    const auto value = kLetters.find(letter);
    if (value == std::string::npos) break;
    held = (held << 6U) | static_cast<unsigned>(value);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<unsigned char>((held >> static_cast<unsigned>(bits)) & 0xFFU));
  }
  return bytes;
}

}  // namespace stillpoint
