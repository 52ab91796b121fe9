#pragma once

#include "ui/shell/canvas.hpp"

namespace stillpoint {

/// Does before the first frame what would hold it up, and the first frame of a sequence: fonts are
/// rasterised, and a software driver compiles what it reduces pictures of each format with.
/// @param width, height of the frames to come, px
void warm_up(Canvas& canvas, int width, int height);

}  // namespace stillpoint
