#pragma once

#include <nlohmann/json.hpp>

#include "core/evaluation/mask_scores.hpp"
#include "core/evaluation/trajectory_metrics.hpp"

namespace stillpoint {

// Results as JSON objects, keys named with their units. Figures that are not known are null; the errors of
// single poses and pairs stay in the structs.

void to_json(nlohmann::json& json, const ErrorStatistics& statistics);
void to_json(nlohmann::json& json, const AbsoluteTrajectoryError& error);
void to_json(nlohmann::json& json, const RelativePoseError& error);
void to_json(nlohmann::json& json, const TrajectoryEvaluation& evaluation);
void to_json(nlohmann::json& json, const MaskScore& score);
void to_json(nlohmann::json& json, const RemovalScore& score);

}  // namespace stillpoint
