#include "tests/support/rendered.hpp"

#include <map>
#include <mutex>
#include <optional>
#include <tuple>

#include "core/sequence/generated/generated_sequence.hpp"

namespace stillpoint {
namespace {

class RenderedOnce final : public FrameSource {
 public:
  explicit RenderedOnce(std::unique_ptr<FrameSource> source) : source_(std::move(source)) {}

  [[nodiscard]] const std::string& name() const override { return source_->name(); }
  [[nodiscard]] const Camera& camera() const override { return source_->camera(); }
  [[nodiscard]] int size() const override { return source_->size(); }
  [[nodiscard]] double timestamp(int index) const override { return source_->timestamp(index); }
  [[nodiscard]] Frame read(int index) const override {
    return kept(frames_, index, [&] { return source_->read(index); });
  }
  [[nodiscard]] FrameTruth truth(int index) const override {
    return kept(truths_, index, [&] { return source_->truth(index); });
  }
  [[nodiscard]] const Trajectory& ground_truth() const override { return source_->ground_truth(); }
  [[nodiscard]] bool has_depth() const override { return source_->has_depth(); }
  [[nodiscard]] bool has_masks() const override { return source_->has_masks(); }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return source_->warnings(); }

 private:
  /// What two threads ask for at once is made twice, and is the same.
  template <typename Value, typename Make>
  Value kept(std::map<int, Value>& all, int index, const Make& make) const {
    {
      const std::lock_guard lock(mutex_);
      if (const auto it = all.find(index); it != all.end()) return it->second;
    }
    Value made = make();
    const std::lock_guard lock(mutex_);
    return all.emplace(index, std::move(made)).first->second;
  }

  std::unique_ptr<FrameSource> source_;
  mutable std::mutex mutex_;
  mutable std::map<int, Frame> frames_;
  mutable std::map<int, FrameTruth> truths_;
};

}  // namespace

std::shared_ptr<const FrameSource> rendered(const std::string& kind, int frames, unsigned seed) {
  static std::mutex mutex;
  static std::map<std::tuple<std::string, int, unsigned>, std::shared_ptr<const FrameSource>> all;
  const std::lock_guard lock(mutex);
  auto& source = all[{kind, frames, seed}];
  if (!source) source = std::make_shared<RenderedOnce>(make_generated_sequence(kind, frames, seed));
  return source;
}

}  // namespace stillpoint
