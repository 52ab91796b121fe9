#pragma once

#include <nlohmann/json.hpp>

#include "app/report/live_pictures.hpp"
#include "app/report/report_run.hpp"

namespace stillpoint {

/// All that an interactive report shows but its pictures, as its scripts read it (assets/report):
///   figures    of frames: {name, title, unit, factor, digits, truth, usual, worse, help}
///   sequences  {name, up, camera: [width, height, fx, fy], pictures,
///              truth: {seconds, positions, turns}, runs}
///   runs       {name, colours: [light, dark], dash, frames, seconds, status, note,
///              positions, turns, keyframes,
///              points: {mm, colours, of}, figures: {NAME: […]}}
/// Lists of a run have one entry a frame of it. Positions (m) and turns (quaternions: x, y, z, w) are those
/// of the final trajectory, each run laid over the truth by its own alignment; null where a frame has no pose
/// of its own. Figures are in the units and to the digits of frames.csv; null where one is not known.
/// @param pictures one a group; their JSON is moved out
[[nodiscard]] nlohmann::ordered_json live_data(const std::vector<ReportGroup>& groups,
                                               std::vector<LivePictures>& pictures);

}  // namespace stillpoint
