#include "core/run/recorded_source.hpp"

#include <utility>
#include <vector>

namespace stillpoint {
namespace {

class RecordedSource final : public FrameSource {
 public:
  RecordedSource(std::shared_ptr<const RecordedRun> run, std::string why)
      : recorded_(std::move(run)), why_(std::move(why)) {}

  [[nodiscard]] const std::string& name() const override { return recorded_->origin.name; }
  [[nodiscard]] const Camera& camera() const override { return recorded_->origin.camera; }
  [[nodiscard]] int size() const override { return static_cast<int>(recorded_->run.records.size()); }
  [[nodiscard]] double timestamp(int index) const override {
    return recorded_->run.records.at(static_cast<std::size_t>(index)).timestamp;
  }
  [[nodiscard]] const Trajectory& ground_truth() const override { return recorded_->ground_truth; }
  [[nodiscard]] bool has_depth() const override { return recorded_->origin.has_depth; }
  [[nodiscard]] bool has_masks() const override { return false; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return warnings_; }
  [[nodiscard]] FrameTruth truth(int) const override { return {}; }

  [[nodiscard]] Frame read(int index) const override {
    Frame frame;
    frame.index = index;
    frame.timestamp = frame.depth_timestamp = timestamp(index);
    frame.problem = why_;
    return frame;
  }

 private:
  std::shared_ptr<const RecordedRun> recorded_;
  std::string why_;
  std::vector<std::string> warnings_;
};

}  // namespace

std::unique_ptr<FrameSource> make_recorded_source(std::shared_ptr<const RecordedRun> run,
                                                  const std::string& why) {
  return std::make_unique<RecordedSource>(std::move(run), why);
}

}  // namespace stillpoint
