#include "tests/support/places.hpp"

namespace stillpoint::places {

const std::string& source() {
  static const std::string path = STILLPOINT_SOURCE_DIR;
  return path;
}

const std::string& build() {
  static const std::string path = STILLPOINT_BINARY_DIR;
  return path;
}

const std::string& output() {
  static const std::string path = STILLPOINT_TEST_OUTPUT_DIR;
  return path;
}

const std::string& program() {
  static const std::string path = STILLPOINT_PROGRAM;
  return path;
}

const std::string& cmake() {
  static const std::string path = STILLPOINT_CMAKE;
  return path;
}

}  // namespace stillpoint::places
