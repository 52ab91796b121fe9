#include "core/sequence/video/video_input.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <string_view>
#include <utility>

#include "core/error.hpp"
#include "core/sequence/bag/random_file.hpp"
#include "core/sequence/video/video_frames.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

class VideoInput final : public SequenceInput {
 public:
  VideoInput(const std::string& path, const OpenOptions& options)
      : path_(path), camera_(options.camera), frames_(path, options.frames, [&options](double share) {
          if (options.progress) options.progress("going through the video", share);
        }) {}

  [[nodiscard]] std::string name() const override { return std::filesystem::path(path_).stem().string(); }
  [[nodiscard]] const std::string& place() const override { return path_; }
  [[nodiscard]] FolderLists lists() override {
    FolderLists lists;
    lists.colours.path = path_;
    for (std::size_t i = 0; i < frames_.stamps().size(); ++i)
      lists.colours.entries.push_back(
          {frames_.stamps()[i], fmt::format("{:06}", i), static_cast<int>(i) + 1});
    return lists;
  }
  [[nodiscard]] FolderTruth truth(const std::vector<double>&, StampUnit) override { return {}; }
  [[nodiscard]] Camera camera(std::vector<std::string>& warnings) override {
    if (camera_) return *camera_;
    if (const auto known = camera_from_folder_name(name())) return *known;
    Camera camera = camera_by_name("ros_default");
    warnings.push_back(fmt::format(
        "{}: a video tells no camera; {} is assumed (--camera NAME|FILE says which)", path_, camera.name));
    return camera;
  }
  [[nodiscard]] ImageRead image(const std::string& file) const override {
    const auto index = parse_number(file);
    if (!index || !is_there(file)) return {{}, path_of(file) + " is not in the video"};
    try {
      cv::Mat image = frames_.image(static_cast<int>(*index));
      if (image.empty()) return {{}, path_of(file) + " cannot be decoded"};
      return {std::move(image), {}};
    } catch (const std::exception& error) {
      return {{}, fmt::format("{} cannot be decoded: {}", path_of(file), error.what())};
    }
  }
  [[nodiscard]] std::string path_of(const std::string& file) const override {
    return fmt::format("{}: frame {}", path_, file);
  }
  [[nodiscard]] std::vector<std::string> warnings() const override { return frames_.warnings(); }

 private:
  [[nodiscard]] bool is_there(const std::string& file) const {
    const auto index = parse_number(file);
    return index && *index >= 0 && *index < static_cast<double>(frames_.stamps().size());
  }

  std::string path_;
  std::optional<Camera> camera_;
  VideoFrames frames_;
};

}  // namespace

bool is_video(const std::string& path) {
  const Bytes start = RandomFile(path).read(0, 16);
  const std::string_view magic(reinterpret_cast<const char*>(start.data()), start.size());
  if (magic.size() < 12) return false;
  const std::string_view box = magic.substr(4, 4);
  return box == "ftyp" || box == "moov" || box == "mdat" || magic.starts_with("\x1A\x45\xDF\xA3") ||
         (magic.starts_with("RIFF") && magic.substr(8, 4) == "AVI ");
}

std::unique_ptr<SequenceInput> make_video_input(const std::string& path, const OpenOptions& options) {
  return std::make_unique<VideoInput>(path, options);
}

}  // namespace stillpoint
