#include "core/image_memory.hpp"

#include <mutex>
#include <opencv2/core.hpp>
#include <unordered_map>
#include <vector>

namespace stillpoint {
namespace {

constexpr std::size_t kSmallest = 4 << 10;   // bytes: below, the system is as fast
constexpr std::size_t kMostKept = 32 << 20;  // bytes: some fifty images of a VGA camera

// A sanitizer tells who touches memory that was let go of; handed on at once, it could not.
#ifdef __SANITIZE_ADDRESS__
constexpr bool kKeeps = false;
#else
constexpr bool kKeeps = true;
#endif

/// Blocks by their size. Never destroyed: images that live as long as the program are let go of after main().
class KeptBlocks {
 public:
  void* take(std::size_t size) {
    {
      const std::lock_guard lock(mutex_);
      if (const auto of_size = kept_.find(size); of_size != kept_.end() && !of_size->second.empty()) {
        void* block = of_size->second.back();
        of_size->second.pop_back();
        counts_.kept_bytes -= size;
        ++counts_.reused;
        return block;
      }
      ++counts_.made;
    }
    return cv::fastMalloc(size);
  }

  void give(void* block, std::size_t size) {
    if (!kKeeps || size > kMostKept) return cv::fastFree(block);
    std::unordered_map<std::size_t, std::vector<void*>> let_go;
    {
      const std::lock_guard lock(mutex_);
      // Mostly sizes no longer asked for; which ones is not known, so all of them go.
      if (counts_.kept_bytes + size > kMostKept) {
        let_go.swap(kept_);
        counts_.kept_bytes = 0;
      }
      kept_[size].push_back(block);
      counts_.kept_bytes += size;
    }
    for (const auto& of_size : let_go)
      for (void* old : of_size.second) cv::fastFree(old);
  }

  [[nodiscard]] ImageMemory counts() {
    const std::lock_guard lock(mutex_);
    return counts_;
  }

 private:
  std::mutex mutex_;
  std::unordered_map<std::size_t, std::vector<void*>> kept_;
  ImageMemory counts_;
};

KeptBlocks& blocks() {
  static auto* const kept = new KeptBlocks;
  return *kept;
}

/// OpenCV's standard allocator, but for where blocks come from and go to.
class KeepingAllocator : public cv::MatAllocator {
 public:
  cv::UMatData* allocate(int dims, const int* sizes, int type, void* data, size_t* step, cv::AccessFlag flags,
                         cv::UMatUsageFlags usage) const override {
    const cv::MatAllocator* standard = cv::Mat::getStdAllocator();
    if (data != nullptr) return standard->allocate(dims, sizes, type, data, step, flags, usage);
    std::size_t total = CV_ELEM_SIZE(type);
    for (int i = dims - 1; i >= 0; --i) {
      if (step) step[i] = total;
      total *= static_cast<std::size_t>(sizes[i]);
    }
    if (total < kSmallest) return standard->allocate(dims, sizes, type, data, step, flags, usage);
    auto* image = new cv::UMatData(this);
    image->data = image->origdata = static_cast<uchar*>(blocks().take(total));
    image->size = total;
    return image;
  }

  bool allocate(cv::UMatData* image, cv::AccessFlag, cv::UMatUsageFlags) const override {
    return image != nullptr;
  }

  void deallocate(cv::UMatData* image) const override {
    if (!image) return;
    CV_Assert(image->urefcount == 0 && image->refcount == 0);
    blocks().give(image->origdata, image->size);
    image->origdata = nullptr;
    delete image;
  }
};

}  // namespace

void keep_image_memory() {
  if (!kKeeps) return;
  static auto* const allocator = new KeepingAllocator;
  cv::Mat::setDefaultAllocator(allocator);
}

ImageMemory image_memory() { return blocks().counts(); }

void* take_memory(std::size_t bytes) { return blocks().take(bytes); }

void give_memory(void* block, std::size_t bytes) { blocks().give(block, bytes); }

}  // namespace stillpoint
