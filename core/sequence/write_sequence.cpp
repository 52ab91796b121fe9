#include "core/sequence/write_sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <exception>
#include <fstream>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <thread>
#include <vector>

#include "core/error.hpp"
#include "core/out_folder.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kImageFolders[] = {"rgb", "depth", "mask"};
constexpr const char* kTextFiles[] = {"rgb.txt",         "depth.txt",        "mask.txt",
                                      "groundtruth.txt", "associations.txt", "camera.toml"};

void write_bytes(const fs::path& path, const void* bytes, std::size_t size) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  file.close();  // a full disk may show only now
  if (!file)
    throw InputError(fmt::format("{} cannot be written: {}", path.string(),
                                 errno != 0 ? std::strerror(errno) : "unknown reason"));
}

void write_png(const fs::path& path, const cv::Mat& image) {
  // Noise hardly packs better at higher levels, and packing must keep up with rendering.
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1}))
    throw InputError(fmt::format("{} cannot be packed as PNG", path.string()));
  write_bytes(path, bytes.data(), bytes.size());
}

bool holds_sequence(const fs::path& folder) {
  const auto there = [&](const char* name) {
    std::error_code error;
    return fs::exists(folder / name, error);
  };
  return std::any_of(std::begin(kTextFiles), std::end(kTextFiles), there) ||
         std::any_of(std::begin(kImageFolders), std::end(kImageFolders), there);
}

/// Removes what write_sequence writes and nothing else.
void clear_sequence(const fs::path& folder) {
  for (const char* name : kTextFiles) fs::remove(folder / name);
  for (const char* name : kImageFolders) {
    if (!fs::is_directory(folder / name)) continue;
    std::vector<fs::path> images;
    for (const auto& entry : fs::directory_iterator(folder / name))
      if (entry.is_regular_file() && entry.path().extension() == ".png") images.push_back(entry.path());
    for (const fs::path& image : images) fs::remove(image);
  }
}

void prepare(const FrameSource& source, const fs::path& folder, bool force) {
  try {
    if (fs::exists(folder) && !fs::is_directory(folder))
      throw InputError(
          fmt::format("{} is a file, expected a folder to write the sequence to", folder.string()));
    if (holds_sequence(folder)) {
      if (!force)
        throw InputError(
            fmt::format("{} holds a sequence already; give --force to replace it", folder.string()));
      clear_sequence(folder);
    }
    fs::create_directories(folder / "rgb");
    if (source.has_depth()) fs::create_directories(folder / "depth");
    if (source.has_masks()) fs::create_directories(folder / "mask");
  } catch (const fs::filesystem_error& error) {
    throw InputError(fmt::format("{} cannot be written to: {}", folder.string(), error.code().message()));
  }
}

std::string image_name(double stamp) { return fmt::format("{:.6f}.png", stamp); }

struct WrittenFrame {
  bool readable = false;
  std::optional<double> depth_stamp;  // s, when the depth image was taken; nothing where there is none
};

WrittenFrame write_frame(const FrameSource& source, int index, const fs::path& folder) {
  const Frame frame = source.read(index);
  WrittenFrame written{.readable = frame.readable(), .depth_stamp = {}};
  const std::string name = image_name(source.timestamp(index));
  if (frame.readable()) write_png(folder / "rgb" / name, frame.colour.empty() ? frame.gray : frame.colour);
  if (source.has_masks())
    if (const FrameTruth truth = source.truth(index); !truth.moving.empty())
      write_png(folder / "mask" / name, truth.moving);
  if (!frame.has_depth()) return written;
  cv::Mat stored;
  frame.depth.convertTo(stored, CV_16U, source.camera().depth_scale);  // rounds to nearest
  write_png(folder / "depth" / image_name(frame.depth_timestamp), stored);
  written.depth_stamp = frame.depth_timestamp;
  return written;
}

/// All frames, by as many threads as wanted; the first failure ends them and is thrown.
/// @returns those that were written: from the first one on
std::vector<WrittenFrame> write_frames(const FrameSource& source, const fs::path& folder,
                                       const WriteOptions& options) {
  std::atomic<int> next{0};
  std::atomic<bool> failed{false};
  std::mutex mutex;  // of done and failure
  int done = 0;
  std::exception_ptr failure;
  std::vector<WrittenFrame> written(static_cast<std::size_t>(source.size()));
  const auto work = [&] {
    // Whoever has taken a frame writes it, so that none is missing before the last.
    while (!failed && !(options.stop != nullptr && *options.stop)) {
      const int i = next++;
      if (i >= source.size()) break;
      try {
        written[static_cast<std::size_t>(i)] = write_frame(source, i, folder);
        const std::lock_guard lock(mutex);
        ++done;
        if (options.progress) options.progress(done, source.size());
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        failed = true;
      }
    }
  };
  std::vector<std::thread> helpers;
  for (int i = 1; i < std::clamp(options.threads, 1, 64); ++i) helpers.emplace_back(work);
  work();
  for (std::thread& helper : helpers) helper.join();
  if (failure) std::rethrow_exception(failure);
  written.resize(static_cast<std::size_t>(done));
  return written;
}

std::string camera_text(const Camera& c) {
  return fmt::format(
      "name = \"{}\"\nwidth = {}\nheight = {}\nfx = {}\nfy = {}\ncx = {}\ncy = {}\n"
      "k1 = {}\nk2 = {}\np1 = {}\np2 = {}\nk3 = {}\ndepth_scale = {}\nreadout_s = {}\n",
      c.name, c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3, c.depth_scale,
      c.readout_s);
}

/// Names the depth image of a frame that has none: one that is not there, and is no other frame's.
std::string no_depth_name(int index) { return fmt::format("none_{:06}.png", index); }

void write_list(const FrameSource& source, const fs::path& folder, const char* name,
                const std::vector<std::optional<double>>& stamps) {
  std::string text = fmt::format("# {} images of {}\n# timestamp filename\n", name, source.name());
  for (const std::optional<double>& stamp : stamps)
    if (stamp) text += fmt::format("{:.6f} {}/{}\n", *stamp, name, image_name(*stamp));
  write_text_file(folder / (std::string(name) + ".txt"), text);
}

/// A pair a frame, whether or not its images are there: readers that go by pairs count frames by them.
void write_pairs(const FrameSource& source, const fs::path& folder,
                 const std::vector<WrittenFrame>& written) {
  std::string pairs;
  for (std::size_t i = 0; i < written.size(); ++i) {
    const int index = static_cast<int>(i);
    const double stamp = source.timestamp(index);
    const auto& depth = written[i].depth_stamp;
    pairs += fmt::format("{0:.6f} rgb/{1} {2:.6f} depth/{3}\n", stamp, image_name(stamp),
                         depth.value_or(stamp), depth ? image_name(*depth) : no_depth_name(index));
  }
  write_text_file(folder / "associations.txt", pairs);
}

void write_lists(const FrameSource& source, const fs::path& folder,
                 const std::vector<WrittenFrame>& written) {
  std::vector<std::optional<double>> colours, depths, masks;
  for (std::size_t i = 0; i < written.size(); ++i) {
    const double stamp = source.timestamp(static_cast<int>(i));
    colours.emplace_back(stamp);
    depths.push_back(written[i].depth_stamp);
    masks.push_back(fs::exists(folder / "mask" / image_name(stamp)) ? std::optional(stamp) : std::nullopt);
  }
  write_text_file(folder / "camera.toml", camera_text(source.camera()));
  if (!source.ground_truth().empty())
    write_tum_trajectory((folder / "groundtruth.txt").string(), source.ground_truth());
  if (source.has_masks()) write_list(source, folder, "mask", masks);
  if (source.has_depth()) {
    write_list(source, folder, "depth", depths);
    write_pairs(source, folder, written);
  }
  write_list(source, folder, "rgb", colours);
}

}  // namespace

void remove_sequence(const fs::path& folder) {
  std::error_code ignored;  // what others put there meanwhile stays, and the folder with it
  clear_sequence(folder);
  for (const char* name : kImageFolders) fs::remove(folder / name, ignored);
  fs::remove(folder, ignored);
}

WrittenSequence write_sequence(const FrameSource& source, const fs::path& folder,
                               const WriteOptions& options) {
  if (source.size() == 0) throw InputError(fmt::format("{} has no frames to write", source.name()));
  prepare(source, folder, options.force);
  const std::vector<WrittenFrame> frames = write_frames(source, folder, options);
  WrittenSequence written{.frames = static_cast<int>(frames.size()), .unreadable = {}};
  for (int i = 0; i < written.frames; ++i)
    if (!frames[static_cast<std::size_t>(i)].readable) written.unreadable.push_back(i);
  if (!frames.empty() && written.unreadable.size() == frames.size()) {
    remove_sequence(folder);
    throw InputError(
        fmt::format("{}: none of the {} frames to write can be read", source.name(), frames.size()));
  }
  if (!frames.empty()) write_lists(source, folder, frames);
  return written;
}

}  // namespace stillpoint
