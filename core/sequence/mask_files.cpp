#include "core/sequence/mask_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <set>

#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/sequence/association.hpp"
#include "core/sequence/image_file.hpp"
#include "core/sequence/list_file.hpp"
#include "core/sequence/stamps.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr double kSameNumber = 0.5;   // frames: numbers are whole
constexpr std::size_t kSample = 8;    // images looked at on opening
constexpr double kNearlyAll = 0.999;  // share of the pixels, to call a mask white all over
constexpr const char* kListNames[] = {"mask.txt", "masks.txt"};
constexpr const char* kFolderNames[] = {"mask", "masks"};

/// The numbers in a name as they stand there: "rgb_1305031102.175304_mask" has "1305031102.175304".
std::vector<std::string> numbers_in(const std::string& name) {
  const auto is_digit = [&name](std::size_t i) {
    return i < name.size() && std::isdigit(static_cast<unsigned char>(name[i])) != 0;
  };
  std::vector<std::string> numbers;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (!is_digit(i)) continue;
    std::size_t end = i;
    while (is_digit(end)) ++end;
    if (end < name.size() && name[end] == '.' && is_digit(end + 1)) {
      ++end;
      while (is_digit(end)) ++end;
    }
    numbers.push_back(name.substr(i, end - i));
    i = end;
  }
  return numbers;
}

/// Which of the numbers in files' names counts the frames: that of most different values, the first of
/// equals.
std::size_t counting_column(const std::vector<std::vector<std::string>>& numbers) {
  std::size_t columns = numbers.empty() ? 0 : numbers.front().size();
  for (const auto& one : numbers) columns = std::min(columns, one.size());
  std::size_t best = 0, most = 0;
  for (std::size_t column = 0; column < columns; ++column) {
    std::set<std::string> values;
    for (const auto& one : numbers) values.insert(one[column]);
    if (values.size() > most) {
      most = values.size();
      best = column;
    }
  }
  return best;
}

std::vector<std::string> images_in(const fs::path& folder) {
  std::vector<std::string> images;
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(folder, failed))
    if (is_image_name(entry.path().string())) images.push_back(entry.path().string());
  if (failed) throw InputError(fmt::format("{}: cannot be opened: {}", folder.string(), failed.message()));
  std::sort(images.begin(), images.end());
  return images;
}

/// "#c00080" as blue, green and red; nothing for another text.
std::optional<cv::Scalar> colour_of(const std::string& label) {
  if (label.size() != 7 || label[0] != '#' || !std::all_of(label.begin() + 1, label.end(), [](char c) {
        return std::isxdigit(static_cast<unsigned char>(c)) != 0;
      }))
    return std::nullopt;
  const auto value = std::strtol(label.c_str() + 1, nullptr, 16);
  return cv::Scalar(static_cast<double>(value & 255), static_cast<double>((value >> 8) & 255),
                    static_cast<double>(value >> 16));
}

void check_labels(const std::vector<std::string>& labels) {
  for (const std::string& label : labels)
    if (!colour_of(label) &&
        (label.empty() || label.size() > 5 || !std::all_of(label.begin(), label.end(), [](char c) {
           return std::isdigit(static_cast<unsigned char>(c)) != 0;
         })))
      throw InputError(
          fmt::format("'{}' is no label; labels are whole numbers, or colours such as #c00080", label));
}

}  // namespace

MaskFiles::MaskFiles(const std::string& where, const MaskReading& reading)
    : where_(where), reading_(reading) {
  check_labels(reading_.labels);
  std::error_code none;
  if (!fs::exists(where, none))
    throw InputError(fmt::format("{}: there is no such folder or list of masks", where));
  if (fs::is_directory(where, none))
    read_folder(where);
  else if (is_image_name(where))
    throw InputError(
        fmt::format("{}: is one image, expected a folder with a mask a frame, or a list of them", where));
  else
    read_list_file(where);
  settle_numbers();
  survey();
}

void MaskFiles::read_folder(const std::string& folder) {
  std::vector<std::string> images = images_in(folder);
  std::error_code none;
  if (images.empty()) {
    for (const char* name : kListNames)
      if (fs::is_regular_file(fs::path(folder) / name, none)) return read_list_file(fs::path(folder) / name);
    for (const char* name : kFolderNames)
      if (images.empty() && fs::is_directory(fs::path(folder) / name, none))
        images = images_in(fs::path(folder) / name);
  }
  if (images.empty()) throw InputError(fmt::format("{}: holds no mask images and no mask.txt", folder));
  std::vector<std::vector<std::string>> numbers;
  for (const std::string& image : images) {
    const std::string name = fs::path(image).stem().string();
    by_name_[name].push_back(image);
    if (auto found = numbers_in(name); !found.empty()) numbers.push_back(std::move(found));
  }
  const std::size_t column = counting_column(numbers);
  for (const std::string& image : images) {
    const auto found = numbers_in(fs::path(image).stem().string());
    if (column >= found.size()) continue;
    by_token_[found[column]].push_back(image);
    if (const auto number = parse_number(found[column])) by_number_[*number].push_back(image);
  }
  if (by_number_.size() < images.size() && !by_number_.empty())
    warnings_.push_back(fmt::format("{}: {} images are named by {} numbers; those of one number are united",
                                    where_, images.size(), by_number_.size()));
}

void MaskFiles::read_list_file(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  for (const ListEntry& entry : read_list(path, warnings_)) {
    const std::string file = (folder / entry.file).string();  // an absolute name stays one
    by_name_[fs::path(file).stem().string()].push_back(file);
    by_number_[entry.timestamp].push_back(file);
  }
}

/// Stamps to seconds; frame numbers to the first one's.
void MaskFiles::settle_numbers() {
  if (by_number_.empty()) return;
  std::vector<double> numbers;
  for (const auto& [number, files] : by_number_) numbers.push_back(number);
  const StampUnit unit = unit_of(numbers);
  const bool whole = std::all_of(numbers.begin(), numbers.end(), [](double n) { return n == std::floor(n); });
  // One small whole number counts frames as well: no camera's clock is at so many seconds.
  stamps_ = unit != StampUnit::frames && !(whole && numbers.back() < 1e7);
  if (stamps_) {
    std::map<double, Files> seconds;
    for (auto& [number, files] : by_number_) seconds[number * seconds_per(unit)] = std::move(files);
    by_number_ = std::move(seconds);
    return;
  }
  first_number_ = reading_.first_number >= 0 ? reading_.first_number : numbers.front() == 1.0 ? 1.0 : 0.0;
  if (reading_.first_number < 0 && first_number_ == 1.0)
    warnings_.push_back(fmt::format(
        "{}: masks are numbered from 1, so 1 is taken for the first frame; masks.first_number says otherwise",
        where_));
}

void MaskFiles::survey() {
  constexpr double kMostMoving = 0.7;  // of the masks' pixels; more look inverted
  if (!reading_.labels.empty()) return;
  ImagePaths sample;
  const std::size_t step = std::max<std::size_t>(1, by_name_.size() / kSample);
  std::size_t i = 0;
  for (const auto& [name, files] : by_name_)
    if (i++ % step == 0) sample.push_back(files.front());
  const MaskSurvey found = survey_masks(sample);
  coding_ = found.coding;
  if (const std::string how = how_read(found, "taken out"); !how.empty()) {
    const bool of_things = found.coloured || found.labels > 1;
    warnings_.push_back(fmt::format("{}: {}{}", where_, how, of_things ? " (masks.labels chooses)" : ""));
  }
  if (found.read > 0 && found.moving_share == 0.0 && !reading_.inverted)
    warnings_.push_back(
        fmt::format("{}: {} looked at, nothing is taken out by any", where_, counted(found.read, "mask")));
  const double moving = reading_.inverted ? 1.0 - found.moving_share : found.moving_share;
  if (found.read > 0 && moving > kMostMoving)
    warnings_.push_back(fmt::format(
        "{}: {:.0f} % of the masks' pixels are said to move; if white is what is static, masks.inverted={} "
        "reads them so",
        where_, 100.0 * moving, reading_.inverted ? "false" : "true"));
}

std::string MaskFiles::naming() const {
  const auto files = [](std::size_t count) {
    return count == 1 ? std::string("its one file is") : fmt::format("its {} files are", count);
  };
  if (by_number_.empty())
    return fmt::format("{} named by no numbers, '{}' first", files(by_name_.size()), by_name_.begin()->first);
  const double first = by_number_.begin()->first, last = by_number_.rbegin()->first;
  if (stamps_) return fmt::format("{} of {:.3f} s to {:.3f} s", files(by_name_.size()), first, last);
  return fmt::format("{} numbered from {:.0f} to {:.0f}", files(by_name_.size()), first, last);
}

const MaskFiles::Files* MaskFiles::files_named(const std::string& name) const {
  if (name.empty()) return nullptr;
  if (const auto same = by_name_.find(name); same != by_name_.end()) return &same->second;
  for (const std::string& number : numbers_in(name))
    if (const auto token = by_token_.find(number); token != by_token_.end())
      if (fs::path(token->second.front()).stem().string().find(name) != std::string::npos)
        return &token->second;
  return nullptr;
}

const MaskFiles::Files* MaskFiles::files_at(double number, double tolerance) const {
  auto nearest = by_number_.lower_bound(number);
  if (nearest == by_number_.end() ||
      (nearest != by_number_.begin() && number - std::prev(nearest)->first <= nearest->first - number))
    if (nearest != by_number_.begin()) --nearest;
  if (nearest == by_number_.end() || std::abs(nearest->first - number) > tolerance) return nullptr;
  return &nearest->second;
}

const MaskFiles::Files* MaskFiles::files_of(const Frame& frame) const {
  if (const Files* named = files_named(frame.name)) return named;
  if (stamps_) return files_at(frame.timestamp, kAssociationTolerance);
  // "12.png" beside a colour image "0012.png" is its mask, whatever the first one's number.
  const bool numbered = !frame.name.empty() && frame.name.size() < 8 &&
                        std::all_of(frame.name.begin(), frame.name.end(),
                                    [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; });
  if (numbered) return files_at(std::atof(frame.name.c_str()), kSameNumber);
  return files_at(frame.index + first_number_, kSameNumber);
}

cv::Mat MaskFiles::decode(const cv::Mat& image, std::string& problem) const {
  if (reading_.labels.empty()) return moving_pixels(image, coding_);
  cv::Mat dynamic(image.size(), CV_8UC1, cv::Scalar(0));
  for (const std::string& label : reading_.labels) {
    const auto colour = colour_of(label);
    if (colour.has_value() != (image.channels() > 1)) {
      problem = colour ? "holds values, and a label is given as a colour"
                       : "is a coloured image, and a label is given as a number; name it as #rrggbb";
      return {};
    }
    cv::Mat of_label;
    if (colour)
      cv::inRange(to_8bit(image), *colour, *colour, of_label);
    else
      of_label = image == std::atoi(label.c_str());
    dynamic |= of_label;
  }
  return dynamic;
}

FoundMask MaskFiles::read(const Frame& frame) const {
  FoundMask found;
  const Files* files = files_of(frame);
  if (files == nullptr) {
    found.problem = fmt::format("{} has no mask for this frame", where_);
    return found;
  }
  const cv::Size size = frame.gray.size();
  for (const std::string& file : *files) {
    const ImageRead read = read_image(file);
    std::string problem = read.problem;
    cv::Mat dynamic;
    if (!read.image.empty() && read.image.size() != size)
      problem = fmt::format("{} is {}x{} px, but the frame is {}x{} px", file, read.image.cols,
                            read.image.rows, size.width, size.height);
    else if (!read.image.empty()) {
      dynamic = decode(read.image, problem);
      if (!problem.empty()) problem = fmt::format("{} {}", file, problem);
    }
    if (!problem.empty()) {
      found.problem = problem;
      continue;
    }
    found.mask = found.mask.empty() ? dynamic : cv::Mat(found.mask | dynamic);
  }
  if (found.mask.empty()) return found;
  if (reading_.inverted) found.mask = found.mask == 0;
  if (cv::countNonZero(found.mask) > kNearlyAll * static_cast<double>(found.mask.total())) {
    found.problem = fmt::format("{} takes out the whole frame and is not used", files->front());
    found.mask.release();
  }
  return found;
}

}  // namespace stillpoint
