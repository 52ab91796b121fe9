#pragma once

#include <string>

/// Where the tests find the tree they were built from and what was built. Only places.cpp is compiled with
/// these paths, so that a compiler cache serves every checkout with all the others.
namespace stillpoint::places {

const std::string& source();   ///< The source tree.
const std::string& build();    ///< The build tree.
const std::string& output();   ///< Where tests may leave pictures to look at.
const std::string& program();  ///< The `stillpoint` program.
const std::string& cmake();    ///< The cmake that configured the build.

}  // namespace stillpoint::places
