#pragma once

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <set>
#include <string>
#include <vector>

#include "core/config.hpp"
#include "core/motion/methods.hpp"
#include "core/motion/regions.hpp"

namespace stillpoint {

/// A frame that a motion method judged, and what it is called in files.
struct JudgedFrame {
  std::string reference;  ///< what it was compared with: an index or a file name; empty = no one frame
  std::string target;
  std::string subfolder{};  ///< of its pictures; empty = the out folder itself
  cv::Mat picture{};        ///< CV_8UC3, as the camera gave it; empty when the frame was not judged
  MotionResult result{};
  std::vector<MotionRegion> regions{};  ///< of the result's mask
  StageLog log{};

  [[nodiscard]] const std::string& note() const { return result.note.empty() ? log.note : result.note; }
};

/// The folder that `stillpoint motion` writes: motion.csv, row by row; motion.json; config.toml; pictures of
/// each frame's layers. Which pictures are its own stands in motion.json, so that a later run takes away no
/// others.
class MotionOutput {
 public:
  /// @param force replace earlier results
  /// @param all_rounds pictures of every round, not of the last alone
  /// @param frames_back how far back a reference lies
  /// @throws InputError when the folder cannot be used, or holds earlier results and `force` is not set
  MotionOutput(const std::filesystem::path& folder, bool force, bool all_rounds, const MethodInfo& method,
               int frames_back);

  /// @throws InputError when a file cannot be written, as finish() does
  void add(const JudgedFrame& frame);
  void finish(const Config& config);

  [[nodiscard]] int frames() const { return static_cast<int>(pairs_.size()); }
  [[nodiscard]] int without_mask() const { return without_mask_; }

 private:
  void write_layers(const JudgedFrame& frame);
  /// @param subfolder of the out folder, made when missing
  void write(const std::filesystem::path& subfolder, const std::string& name, const cv::Mat& picture);
  void write_json() const;

  std::filesystem::path folder_;
  bool all_rounds_;
  const MethodInfo& method_;
  int frames_back_;
  std::ofstream csv_;
  nlohmann::json pairs_ = nlohmann::json::array();
  std::set<std::string> pictures_;  ///< names of the files that are ours
  int without_mask_ = 0;
};

}  // namespace stillpoint
