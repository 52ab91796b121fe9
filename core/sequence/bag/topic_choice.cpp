#include "core/sequence/bag/topic_choice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <map>
#include <set>

#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/sequence/bag/messages.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

constexpr const char* kImage = "sensor_msgs/Image";
constexpr const char* kCompressed = "sensor_msgs/CompressedImage";
constexpr const char* kInfo = "sensor_msgs/CameraInfo";

ImageTopic look_at(const MessageLog& log, std::size_t topic) {
  ImageTopic image;
  image.topic = topic;
  const LoggedTopic& logged = log.topics()[topic];
  image.is_compressed = logged.type == kCompressed;
  const auto has_told = [&image] {
    return !image.encoding.empty() && (image.is_compressed || !image.size.empty());
  };
  for (std::size_t i = 0; i < std::min(logged.times.size(), kFirstMessages) && !has_told(); ++i) {
    try {
      const Bytes head = log.read(topic, i, kImageHeadBytes);
      const ImageMessage message = image_message(head, logged.format, image.is_compressed, false);
      if (message.encoding.empty()) continue;
      image.encoding = message.encoding, image.frame = message.header.frame;
      image.may_be_depth = message.may_be_depth(), image.is_float = message.is_float();
      if (message.width <= kLargestImageSide && message.height <= kLargestImageSide)
        image.size = cv::Size(static_cast<int>(message.width), static_cast<int>(message.height));
      // compressed_image_transport gives depth that was not compressed for depth as plain PNG, and names no
      // kind.
      const std::string name = lower_case(logged.name);
      if (image.is_compressed && message.encoding.find("8UC") == std::string::npos &&
          name.find("depth") != std::string::npos && message.encoding.find("png") != std::string::npos)
        image.may_be_depth = true;
    } catch (const MalformedBytes&) {  // the next may tell
    }
  }
  return image;
}

constexpr int kIsColour = 5;  // of colour_score: infrared images are below

/// How likely a topic is the colour images; below 0 it is not.
int colour_score(const ImageTopic& image, const LoggedTopic& topic) {
  const std::string name = lower_case(topic.name);
  if (image.may_be_depth || image.encoding.empty() || has_any(name, {"depth", "disparity", "confidence"}))
    return -1;
  int score = has_any(name, {"rgb", "color", "colour"}) ? 40 : 10;
  if (has_any(name, {"infra", "/ir/", "ir_", "thermal"})) score = 1;
  if (has_any(name, {"fisheye", "right"})) score -= 1;
  if (!image.is_compressed) score += 4;
  if (has_any(name, {"rect"})) score += 2;
  if (image.encoding.starts_with("mono8") || image.encoding.starts_with("8UC1")) score -= 5;
  return std::max(score, 0);
}

int depth_score(const ImageTopic& image, const LoggedTopic& topic) {
  const std::string name = lower_case(topic.name);
  if (!image.may_be_depth || has_any(name, {"disparity", "confidence", "infra", "/ir/"})) return -1;
  int score = has_any(name, {"depth"}) ? 20 : 5;
  if (has_any(name, {"aligned", "registered", "to_color", "to_rgb"})) score += 20;
  if (has_any(name, {"rect"})) score += 2;
  if (!image.is_compressed) score += 4;
  return score;
}

/// The name of the camera that a topic of images is of: what stands before the part that tells the image.
std::string camera_name(const std::string& topic) {
  std::size_t end = topic.find('/', 1);
  for (std::size_t begin = 0; end != std::string::npos; begin = end, end = topic.find('/', end + 1)) {
    const std::string part = topic.substr(begin, end - begin);
    const bool is_camera = has_any(part, {"cam", "rgbd"});  // depth_cam is no image's name
    if (!is_camera && has_any(part, {"depth", "rgb", "color", "colour", "image", "infra"}))
      return topic.substr(0, begin);
  }
  return topic.substr(0, topic.rfind('/'));
}

std::size_t shared_parts(const std::string& a, const std::string& b) {
  std::size_t parts = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()) && a[i] == b[i]; ++i) parts += a[i] == '/' ? 1 : 0;
  return parts;
}

/// The frame that a topic of CameraInfo is of.
std::string frame_of(const MessageLog& log, std::size_t info) {
  const LoggedTopic& topic = log.topics()[info];
  for (std::size_t i = 0; i < std::min(topic.times.size(), kFirstMessages); ++i) {
    try {
      return camera_info_message(log.read(info, i), topic.format).header.frame;
    } catch (const MalformedBytes&) {  // the next may tell
    }
  }
  return {};
}

/// `colour=/a,depth=/b` taken apart.
std::map<std::string, std::string> asked_for(const std::string& asked) {
  std::map<std::string, std::string> topics;
  for (std::size_t at = 0; at < asked.size();) {
    const std::size_t end = std::min(asked.find(',', at), asked.size());
    const std::string part = asked.substr(at, end - at);
    at = end + 1;
    const std::size_t equals = part.find('=');
    std::string key = part.substr(0, equals);
    if (key == "color" || key == "rgb") key = "colour";
    if (equals == std::string::npos || equals + 1 == part.size() ||
        (key != "colour" && key != "depth" && key != "info" && key != "truth"))
      throw InputError(fmt::format(
          "--topics: found '{}', expected colour=TOPIC,depth=TOPIC,info=TOPIC,truth=TOPIC", part));
    if (!topics.try_emplace(key, part.substr(equals + 1)).second)
      throw InputError(fmt::format("--topics: {} is named twice", key));
  }
  return topics;
}

class Chooser {
 public:
  Chooser(const MessageLog& log, const std::string& asked) : log_(log), asked_(asked_for(asked)) {
    for (std::size_t i = 0; i < log.topics().size(); ++i) {
      const LoggedTopic& topic = log.topics()[i];
      const bool is_image = topic.type == kImage || topic.type == kCompressed;
      if (is_image && !topic.times.empty() && topic.format != WireFormat::other)
        images_.push_back(look_at(log, i));
    }
  }

  TopicChoice choose() {
    TopicChoice choice;
    if (const auto named = asked("colour", is_image))
      choice.colour = look_at(log_, *named);
    else if (const auto found = best([this](const ImageTopic& image, const LoggedTopic& topic) {
               constexpr int kWithDepth = 6;  // more than being raw, less than being named colour
               const int score = colour_score(image, topic);
               return score >= kIsColour && has_depth_beside(image) ? score + kWithDepth : score;
             }))
      choice.colour = *found;
    else
      throw InputError(no_images());
    if (const auto named = asked("depth", is_image))
      choice.depth = look_at(log_, *named);
    else if (!is_none("depth"))
      choice.depth = best([&](const ImageTopic& image, const LoggedTopic& topic) {
        constexpr int kOfTheCamera = 100;  // of one camera with colour before whatever its name says
        const int score = depth_score(image, topic);
        return score >= 0 && are_of_one_camera(image, choice.colour) ? score + kOfTheCamera : score;
      });
    if (!asked_.contains("colour")) tell_other_cameras(choice);
    tell_unreadable(choice);
    if (const auto named = asked("info", [](const LoggedTopic& topic) { return topic.type == kInfo; }))
      choice.info = named;
    else if (!is_none("info"))
      choice.info = info_beside(log_, choice.colour);
    choice.no_info = is_none("info");
    choice.truth = asked(
        "truth", [](const LoggedTopic& topic) { return is_tf_type(topic.type) || is_pose_type(topic.type); });
    choice.no_truth = is_none("truth");
    return choice;
  }

 private:
  static bool is_image(const LoggedTopic& topic) { return topic.type == kImage || topic.type == kCompressed; }

  [[nodiscard]] bool is_none(const std::string& key) const {
    const auto named = asked_.find(key);
    return named != asked_.end() && named->second == "none" && key != "colour";
  }

  /// The topic asked for. @throws InputError where it is not there or does not fit
  [[nodiscard]] std::optional<std::size_t> asked(const std::string& key,
                                                 const std::function<bool(const LoggedTopic&)>& fits) const {
    const auto named = asked_.find(key);
    if (named == asked_.end() || is_none(key)) return std::nullopt;
    std::vector<std::string> others;
    for (std::size_t i = 0; i < log_.topics().size(); ++i) {
      const LoggedTopic& topic = log_.topics()[i];
      if (fits(topic)) others.push_back(topic.name);
      if (topic.name != named->second && topic.name != "/" + named->second) continue;
      if (!fits(topic))
        throw InputError(fmt::format("{}: {} holds {}, which cannot be read as {}", log_.path(), topic.name,
                                     topic.type, key));
      if (topic.times.empty())
        throw InputError(fmt::format("{}: {} holds no messages", log_.path(), topic.name));
      if (topic.format == WireFormat::other)
        throw InputError(fmt::format("{}: {} is encoded as '{}', and ROS 1's and CDR are read", log_.path(),
                                     topic.name, topic.encoding));
      return i;
    }
    throw InputError(fmt::format("{}: has no topic {}; as {} it has {}", log_.path(), named->second, key,
                                 others.empty() ? "none" : fmt::format("{}", fmt::join(others, ", "))));
  }

  [[nodiscard]] std::string camera_of(const ImageTopic& image) const {
    const std::string name = camera_name(log_.topics()[image.topic].name);
    return name.empty() ? "/" : name;
  }
  [[nodiscard]] bool are_of_one_camera(const ImageTopic& a, const ImageTopic& b) const {
    return camera_of(a) == camera_of(b) || (!a.frame.empty() && a.frame == b.frame);
  }

  [[nodiscard]] bool has_depth_beside(const ImageTopic& colour) const {
    return std::any_of(images_.begin(), images_.end(), [&](const ImageTopic& image) {
      return depth_score(image, log_.topics()[image.topic]) >= 0 && are_of_one_camera(image, colour);
    });
  }

  /// Cameras of which both colour and depth are there; nobody but the user knows which is meant.
  void tell_other_cameras(TopicChoice& choice) const {
    std::set<std::string> coloured, whole;
    for (const ImageTopic& image : images_)
      if (colour_score(image, log_.topics()[image.topic]) >= kIsColour) coloured.insert(camera_of(image));
    for (const ImageTopic& image : images_)
      if (depth_score(image, log_.topics()[image.topic]) >= 0 && coloured.contains(camera_of(image)))
        whole.insert(camera_of(image));
    if (whole.size() > 1)
      choice.warnings.push_back(
          fmt::format("{}: {} cameras have colour and depth, {}; {} was taken (`--topics "
                      "colour=TOPIC` takes another)",
                      log_.path(), whole.size(), fmt::join(whole, ", "), camera_of(choice.colour)));
  }

  void tell_unreadable(TopicChoice& choice) const {
    for (const ImageTopic& image : images_) {
      if (!image.encoding.empty()) continue;
      const LoggedTopic& topic = log_.topics()[image.topic];
      std::string sentence =
          fmt::format("{}:{}: none of its first {} says what image it holds; it was left out", log_.path(),
                      topic.name, counted(std::min(topic.times.size(), kFirstMessages), "message"));
      if (!choice.depth && !is_none("depth") && has_any(topic.name, {"depth"}))
        choice.why_no_depth = std::move(sentence);
      else
        choice.warnings.push_back(std::move(sentence));
    }
  }

  template <typename Score>
  [[nodiscard]] std::optional<ImageTopic> best(const Score& score) const {
    std::optional<ImageTopic> found;
    int highest = -1;
    for (const ImageTopic& image : images_) {
      const int value = score(image, log_.topics()[image.topic]);
      if (value > highest) found = image, highest = value;
    }
    return found;
  }

  [[nodiscard]] std::string no_images() const {
    std::vector<std::string> holds;
    for (const LoggedTopic& topic : log_.topics())
      holds.push_back(fmt::format("{} ({}{})", topic.name, topic.type,
                                  topic.format == WireFormat::other ? ", as '" + topic.encoding + "'" : ""));
    constexpr std::size_t kMost = 8;  // topics: a hint, and no listing
    if (holds.size() > kMost) holds.resize(kMost), holds.emplace_back("…");
    return fmt::format("{}: holds no colour images that can be read; it holds {}", log_.path(),
                       holds.empty() ? "no messages" : fmt::format("{}", fmt::join(holds, ", ")));
  }

  const MessageLog& log_;
  std::map<std::string, std::string> asked_;
  std::vector<ImageTopic> images_;
};

}  // namespace

bool has_any(const std::string& name, std::initializer_list<const char*> parts) {
  const std::string small = lower_case(name);
  return std::any_of(parts.begin(), parts.end(),
                     [&](const char* part) { return small.find(part) != std::string::npos; });
}

TopicChoice choose_topics(const MessageLog& log, const std::string& asked) {
  return Chooser(log, asked).choose();
}

std::vector<std::size_t> info_topics(const MessageLog& log) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < log.topics().size(); ++i)
    if (const LoggedTopic& topic = log.topics()[i];
        topic.type == kInfo && !topic.times.empty() && topic.format != WireFormat::other)
      found.push_back(i);
  return found;
}

std::optional<std::size_t> info_beside(const MessageLog& log, const ImageTopic& images) {
  std::optional<std::size_t> found;
  std::size_t most = 1;  // the first slash, which all share
  const std::vector<std::size_t> infos = info_topics(log);
  for (const std::size_t i : infos) {
    const std::size_t shared = shared_parts(log.topics()[i].name, log.topics()[images.topic].name);
    if (shared > most) found = i, most = shared;
  }
  if (found || images.frame.empty()) return found;
  for (const std::size_t i : infos) {
    if (frame_of(log, i) != images.frame) continue;
    if (found) return std::nullopt;
    found = i;
  }
  return found;
}

std::vector<std::string> describe_topics(const MessageLog& log, const TopicChoice& choice,
                                         std::optional<std::size_t> truth) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < log.topics().size(); ++i) {
    const LoggedTopic& topic = log.topics()[i];
    std::string as;
    if (i == choice.colour.topic) as = "  read as colour";
    if (choice.depth && i == choice.depth->topic) as += "  read as depth";
    if (choice.info == i) as += "  read as info";
    if (truth == i) as += "  read as truth";
    lines.push_back(fmt::format("{}  {}  {} messages{}", topic.name, topic.type, topic.times.size(), as));
  }
  return lines;
}

}  // namespace stillpoint
