#include "core/sequence/bag/bag_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/sequence/bag/bag_camera.hpp"
#include "core/sequence/bag/bag_image.hpp"
#include "core/sequence/bag/bag_stamps.hpp"
#include "core/sequence/bag/bag_truth.hpp"
#include "core/sequence/bag/frame_tree.hpp"
#include "core/sequence/bag/messages.hpp"
#include "core/sequence/bag/topic_choice.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr double kMillimetres = 1000.0;  // units a metre
constexpr double kTumScale = 5000.0;  // units a metre of TUM's PNG images, whose metres times 5000 they are

class BagInput final : public SequenceInput {
 public:
  BagInput(std::unique_ptr<MessageLog> log, const OpenOptions& options)
      : log_(std::move(log)), options_(options), choice_(choose_topics(*log_, options.topics)) {
    options_.progress = nullptr;  // of the opening alone
    truth_ = read_bag_truth(*log_, choice_, choice_.colour.frame);
    whole_ = fs::absolute(log_->path()).lexically_normal();
  }

  [[nodiscard]] std::string name() const override { return whole_.stem().string(); }
  [[nodiscard]] const std::string& place() const override { return log_->path(); }

  [[nodiscard]] FolderLists lists() override {
    FolderLists lists;
    lists.warnings = choice_.warnings, lists.why_no_depth = choice_.why_no_depth;
    lists.colours = list_of(choice_.colour, lists.warnings);
    if (lists.colours.entries.empty())
      throw InputError(fmt::format("{}: not one of its messages can be read", lists.colours.path));
    if (choice_.depth) {
      lists.depths = list_of(*choice_.depth, lists.warnings);
      tell_registration(lists.warnings);
      if (lists.depths->entries.empty()) {
        lists.why_no_depth = fmt::format("{}: not one of its messages can be read", lists.depths->path);
        lists.depths.reset();
      }
    }
    return lists;
  }

  [[nodiscard]] FolderTruth truth(const std::vector<double>& stamps, StampUnit unit) override {
    FolderTruth settled;
    settled.why_not = truth_.why_not;
    if (!truth_.poses.empty())
      settled = settle_truth(truth_.path, truth_.poses, stamps, unit, options_.frame_rate, options_.truth);
    settled.warnings.insert(settled.warnings.begin(), truth_.warnings.begin(), truth_.warnings.end());
    return settled;
  }

  [[nodiscard]] Camera camera(std::vector<std::string>& warnings) override {
    Camera camera = options_.camera ? *options_.camera : camera_told(warnings);
    if (choice_.depth && !choice_.depth->is_float) camera.depth_scale = units_a_metre();
    // TUM's metres are those of its PNG images, which its cameras are calibrated for.
    for (const Camera& known : known_cameras())
      if (known.name == camera.name) metre_ = kTumScale / known.depth_scale;
    if (options_.depth_scale) metre_ = 1.0 / *options_.depth_scale;
    return camera;
  }

  [[nodiscard]] ImageRead image(const std::string& file) const override {
    const std::string path = path_of(file);
    try {
      const auto bracket = file.rfind('[');
      std::size_t message = 0;
      const std::string_view number = std::string_view(file).substr(bracket + 1);
      std::from_chars(number.data(), number.data() + number.size(), message);
      const ImageTopic& topic =
          file.compare(0, bracket, name_of(choice_.colour)) == 0 && name_of(choice_.colour).size() == bracket
              ? choice_.colour
              : *choice_.depth;
      const Bytes bytes = log_->read(topic.topic, message);
      ImageRead read =
          image_of(image_message(bytes, log_->topics()[topic.topic].format, topic.is_compressed), path);
      if (read.in_metres && metre_ != 1.0) read.image *= metre_;
      return read;
    } catch (const std::exception& error) {
      ImageRead read;
      read.problem = fmt::format("{} {}", path, error.what());
      return read;
    }
  }

  [[nodiscard]] std::string path_of(const std::string& file) const override {
    return log_->path() + ":" + file;
  }
  [[nodiscard]] std::vector<std::string> contents() const override {
    return describe_topics(*log_, choice_, truth_.poses.empty() ? std::nullopt : truth_.topic);
  }
  [[nodiscard]] std::vector<std::string> warnings() const override { return log_->warnings(); }

 private:
  [[nodiscard]] const std::string& name_of(const ImageTopic& topic) const {
    return log_->topics()[topic.topic].name;
  }

  /// The messages of a topic by strictly increasing stamp.
  [[nodiscard]] ImageList list_of(const ImageTopic& topic, std::vector<std::string>& warnings) const {
    const LoggedTopic& logged = log_->topics()[topic.topic];
    ImageList list{fmt::format("{}:{}", log_->path(), logged.name), {}};
    std::vector<std::int64_t> stamps, recorded;
    std::vector<std::size_t> messages;
    for (std::size_t i = 0; i < logged.times.size(); ++i) {
      try {
        stamps.push_back(stamp_of(log_->read(topic.topic, i, kStampBytes), logged.format));
        recorded.push_back(logged.times[i]);
        messages.push_back(i);
      } catch (const MalformedBytes&) {  // counted below
      }
    }
    if (messages.size() < logged.times.size())
      warnings.push_back(fmt::format("{}: {} of {} messages cannot be read and were left out", list.path,
                                     logged.times.size() - messages.size(), logged.times.size()));
    const BagStamps settled = settle_bag_stamps(std::move(stamps), recorded);
    if (!settled.told.empty()) warnings.push_back(fmt::format("{}: {}", list.path, settled.told));
    for (std::size_t i = 0; i < messages.size(); ++i)
      list.entries.push_back({seconds_of(settled.stamps[i]), fmt::format("{}[{}]", logged.name, messages[i]),
                              static_cast<int>(messages[i])});
    put_in_order(list, warnings);
    return list;
  }

  static void put_in_order(ImageList& list, std::vector<std::string>& warnings) {
    const auto earlier = [](const ListEntry& a, const ListEntry& b) { return a.timestamp < b.timestamp; };
    if (!std::is_sorted(list.entries.begin(), list.entries.end(), earlier)) {
      warnings.push_back(
          fmt::format("{}: messages were recorded in another order than that of their stamps; "
                      "they were sorted by stamp",
                      list.path));
      std::stable_sort(list.entries.begin(), list.entries.end(), earlier);
    }
    const auto same = [](const ListEntry& a, const ListEntry& b) { return a.timestamp == b.timestamp; };
    const std::size_t before = list.entries.size();
    list.entries.erase(std::unique(list.entries.begin(), list.entries.end(), same), list.entries.end());
    if (before > list.entries.size())
      warnings.push_back(fmt::format("{}: {} with an earlier one's stamp dropped", list.path,
                                     counted(before - list.entries.size(), "message")));
  }

  /// The camera that a topic of images is said to be of.
  [[nodiscard]] std::optional<Camera> camera_beside(const ImageTopic& images) const {
    const auto info = info_beside(*log_, images);
    std::string why_not;
    std::vector<std::string> ignored;
    return info ? camera_of_topic(*log_, *info, false, images.size, why_not, ignored) : std::nullopt;
  }

  void tell_registration(std::vector<std::string>& warnings) const {
    constexpr double kSameCamera = 0.01;  // relative difference of focal lengths
    std::string differs;
    const std::string &colour = choice_.colour.frame, &depth = choice_.depth->frame;
    if (!colour.empty() && !depth.empty() && colour != depth)
      differs = fmt::format("depth is of frame {} and colour of frame {}", depth, colour);
    const auto colours = camera_beside(choice_.colour), depths = camera_beside(*choice_.depth);
    if (differs.empty() && colours && depths && colours->width == depths->width &&
        std::abs(depths->fx / colours->fx - 1.0) > kSameCamera)
      differs = fmt::format("depth is of a camera of {:.1f} px and colour of one of {:.1f} px", depths->fx,
                            colours->fx);
    if (differs.empty()) return;
    warnings.push_back(
        fmt::format("{}:{}: {}; it is read as if it were registered to colour, which a topic such as "
                    "aligned_depth_to_color is",
                    log_->path(), name_of(*choice_.depth), differs));
  }

  /// What the recording says of the camera, and its name.
  [[nodiscard]] Camera camera_told(std::vector<std::string>& warnings) const {
    std::optional<Camera> named = camera_from_folder_name(whole_.stem().string());
    if (!named) named = camera_from_folder_name(whole_.parent_path().filename().string());
    std::string why_not = why_no_info();
    if (choice_.info) {
      const bool is_rectified = name_of(choice_.colour).find("rect") != std::string::npos;
      const auto camera =
          camera_of_topic(*log_, *choice_.info, is_rectified, choice_.colour.size, why_not, warnings);
      if (camera && named && is_factory_default(*camera)) {
        warnings.push_back(
            fmt::format("{}:{}: is the calibration a driver makes up; that of {} was taken, as the "
                        "name says (--camera says otherwise)",
                        log_->path(), log_->topics()[*choice_.info].name, named->name));
        return *named;
      }
      if (camera) return *camera;
    }
    if (named) return *named;
    Camera camera = camera_by_name("ros_default");
    warnings.push_back(
        fmt::format("{}; {} is assumed (--camera NAME|FILE says which)", why_not, camera.name));
    return camera;
  }

  [[nodiscard]] std::string why_no_info() const {
    if (choice_.no_info) return fmt::format("{}: its CameraInfo is left out", log_->path());
    std::string why = fmt::format("{}: holds no sensor_msgs/CameraInfo of the colour images", log_->path());
    if (const std::vector<std::size_t> infos = info_topics(*log_); !infos.empty())
      why += fmt::format(" (`--topics info={}` takes {})", log_->topics()[infos.front()].name,
                         infos.size() == 1 ? "that of another" : "one of others");
    return why;
  }

  /// Of depth images of 16 bits.
  [[nodiscard]] double units_a_metre() const {
    const std::string& depth = name_of(*choice_.depth);
    const std::string sensor = depth.substr(0, depth.find("/Depth_"));
    for (std::size_t i = 0; i < log_->topics().size(); ++i) {
      const LoggedTopic& topic = log_->topics()[i];
      if (topic.type != "std_msgs/Float32" || topic.times.empty() || !topic.name.starts_with(sensor) ||
          topic.name.find("Depth_Units") == std::string::npos)
        continue;
      try {
        const double unit = float_message(log_->read(i, 0), topic.format);
        if (unit > 1e-6 && unit < 1.0) return 1.0 / unit;
      } catch (const MalformedBytes&) {  // millimetres, then, as RealSense has them unless told otherwise
      }
    }
    return kMillimetres;
  }

  std::unique_ptr<MessageLog> log_;
  OpenOptions options_;
  TopicChoice choice_;
  BagTruth truth_;
  fs::path whole_;
  double metre_ = 1.0;  ///< m of a float
};

}  // namespace

std::unique_ptr<SequenceInput> make_bag_input(std::unique_ptr<MessageLog> log, const OpenOptions& options) {
  return std::make_unique<BagInput>(std::move(log), options);
}

}  // namespace stillpoint
