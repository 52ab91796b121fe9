#pragma once

// The version of Stillpoint. CMakeLists.txt reads it here. While the first number is 0, a new second number
// may change what programs on the library rely on; a new third one does not.

#define STILLPOINT_VERSION_MAJOR 0
#define STILLPOINT_VERSION_MINOR 1
#define STILLPOINT_VERSION_PATCH 0
#define STILLPOINT_VERSION "0.1.0"
