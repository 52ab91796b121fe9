#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/trajectory.hpp"
#include "core/motion/stage_log.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/frame_scores.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/frame.hpp"

namespace stillpoint {

/// A run as an MCAP file, in Foxglove's schemas, so that Foxglove, Rerun and PlotJuggler open it:
///
///   /camera/colour        CompressedImage, JPEG
///   /camera/depth         RawImage 16UC1, mm
///   /camera/mask          CompressedImage, PNG: what was removed
///   /camera/calibration   CameraCalibration
///   /camera/features      ImageAnnotations: features by what became of them, and their way since the last
///   frame /stages/ID            a stage's layer, chosen by its id: CompressedImage PNG, or RawImage 32FC1
///   /tf                   FrameTransforms: world to camera, and to truth
///   /features             PointCloud of the features with depth, in the camera
///   /estimate, /truth     PosesInFrame, in the world of the estimate: the truth is aligned to it
///   /map                  PointCloud of the map at the end
///   /log                  Log: frames that were lost or have a remark
///   /figures              JSON: every figure of the frame that is known
///
/// Stamps are those of the colour images.
class McapExport {
 public:
  /// @throws InputError when the file cannot be made
  McapExport(const std::string& path, const Camera& camera);
  ~McapExport();
  McapExport(const McapExport&) = delete;
  McapExport& operator=(const McapExport&) = delete;

  /// A frame of the run, in order. @param mask what was removed; empty = nothing
  /// @param layers the stages' layers that were asked for
  void add(const Frame& frame, const FrameRecord& record, const cv::Mat& mask,
           const std::vector<const Layer*>& layers = {});

  /// What is known once the run has ended; ends the file.
  /// @throws InputError when not everything could be written
  void finish(const RunResult& run, const Trajectory& ground_truth);

  [[nodiscard]] std::uint64_t messages() const;
  /// What to tell of depth that millimetres in 16 bits cannot hold; "" where there is none.
  [[nodiscard]] std::string too_far() const;

 private:
  struct Channels;
  std::unique_ptr<Channels> channels_;
  Camera camera_;
  std::vector<FeatureRecord> features_before_;
  std::vector<std::uint64_t> times_;  // ns, of the frames
  std::int64_t too_far_ = 0;          // pixels
  bool calibrated_ = false;
};

/// A layout for Foxglove that shows such a file, as JSON.
[[nodiscard]] std::string foxglove_layout();

}  // namespace stillpoint
