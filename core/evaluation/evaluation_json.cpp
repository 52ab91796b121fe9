#include "core/evaluation/evaluation_json.hpp"

namespace stillpoint {
namespace {

nlohmann::json or_null(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

nlohmann::json text_or_null(const std::string& text) {
  return text.empty() ? nlohmann::json() : nlohmann::json(text);
}

}  // namespace

void to_json(nlohmann::json& json, const ErrorStatistics& s) {
  if (s.count == 0) {
    json = {{"count", 0},        {"rmse", nullptr},           {"mean", nullptr},
            {"median", nullptr}, {"stddev", nullptr},         {"min", nullptr},
            {"max", nullptr},    {"lower_quartile", nullptr}, {"upper_quartile", nullptr}};
    return;
  }
  json = {{"count", s.count},
          {"rmse", s.rmse},
          {"mean", s.mean},
          {"median", s.median},
          {"stddev", s.stddev},
          {"min", s.min},
          {"max", s.max},
          {"lower_quartile", s.lower_quartile},
          {"upper_quartile", s.upper_quartile}};
}

void to_json(nlohmann::json& json, const AbsoluteTrajectoryError& error) {
  json = {
      {"translation_m", error.translation_m},
      {"rotation_deg", error.rotation_deg},
      {"alignment_degenerate", error.alignment.degenerate},
      {"scale", error.similarity ? nlohmann::json(error.similarity->scale) : nlohmann::json()},
      {"rmse_with_scale_m", error.similarity ? nlohmann::json(error.similarity->rmse_m) : nlohmann::json()},
      {"why_none", text_or_null(error.why_none)}};
}

void to_json(nlohmann::json& json, const RelativePoseError& error) {
  json = {{"delta", error.delta},
          {"pairs", error.errors.size()},
          {"dropped", error.dropped},
          {"limit_s", error.limit_s},
          {"translation_m", error.translation_m},
          {"rotation_deg", error.rotation_deg},
          {"why_none", text_or_null(error.why_none)}};
}

void to_json(nlohmann::json& json, const TrajectoryEvaluation& e) {
  json = {{"matched", e.matched.size()},
          {"estimated_poses", e.estimated_poses},
          {"truth_poses", e.truth_poses},
          {"expected_frames", e.expected_frames > 0 ? nlohmann::json(e.expected_frames) : nlohmann::json()},
          {"coverage", or_null(e.coverage)},
          {"truth_span_s", e.truth_span_s},
          {"matched_span_s", e.matched_span_s},
          {"applied_scale", e.applied_scale},
          {"ate", e.ate},
          {"rpe_time", e.rpe_time},
          {"rpe_frame", e.rpe_frame},
          {"rpe_more", e.rpe_more},
          {"by_length", e.by_length}};
}

void to_json(nlohmann::json& json, const MaskScore& score) {
  json = {{"precision", or_null(score.precision())},
          {"recall", or_null(score.recall())},
          {"iou", or_null(score.iou())},
          {"found_rightly_px", score.found_rightly},
          {"found_wrongly_px", score.found_wrongly},
          {"missed_px", score.missed},
          {"left_rightly_px", score.left_rightly}};
}

void to_json(nlohmann::json& json, const RemovalScore& score) {
  json = {{"precision", or_null(score.precision())},  {"recall", or_null(score.recall())},
          {"removed_rightly", score.removed_rightly}, {"removed_wrongly", score.removed_wrongly},
          {"kept_wrongly", score.kept_wrongly},       {"kept_rightly", score.kept_rightly}};
}

}  // namespace stillpoint
