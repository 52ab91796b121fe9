#pragma once

#include <imgui.h>

namespace stillpoint {

/// Fills a rectangle with rounded corners, as ImDrawList::AddRectFilled() does and to the same pixels, but
/// for a grey level at corners of a small radius. All of it but the rows of its corners is a plain rectangle,
/// which in software is filled at a fraction of the cost.
void fill_rounded(ImDrawList& list, ImVec2 low, ImVec2 high, ImU32 colour, float rounding);

}  // namespace stillpoint
