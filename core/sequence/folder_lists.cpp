#include "core/sequence/folder_lists.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <initializer_list>
#include <set>

#include "core/error.hpp"
#include "core/sequence/association.hpp"
#include "core/sequence/image_file.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using Names = std::initializer_list<const char*>;

constexpr Names kAssociations = {"associations.txt", "associate.txt", "association.txt", "assoc.txt"};
constexpr Names kColourLists = {"rgb.txt", "color.txt", "colour.txt", "image.txt", "images.txt"};
constexpr Names kDepthLists = {"aligned_depth.txt", "depth.txt"};
constexpr Names kMaskLists = {"mask.txt", "masks.txt"};
constexpr Names kColourFolders = {"rgb", "color", "colour", "image", "images"};
constexpr Names kDepthFolders = {"depth", "aligned_depth"};
constexpr Names kMaskFolders = {"mask", "masks"};

/// The first of these names that the folder holds.
std::optional<std::string> first_there(const FileStore& folder, Names names) {
  for (const char* name : names)
    if (folder.is_there(name)) return name;
  return std::nullopt;
}

/// The number a file's name is, or ends in ("frame-000012.color").
std::optional<double> number_in(const fs::path& file) {
  const std::string stem = file.stem().string();
  if (const auto whole = parse_number(stem)) return whole;
  const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  const auto last = std::find_if(stem.rbegin(), stem.rend(), is_digit);
  const auto before = std::find_if_not(last, stem.rend(), is_digit);
  return parse_number(std::string(before.base(), last.base()));
}

std::vector<double> stamps_of(const ImageList& list) {
  std::vector<double> stamps;
  stamps.reserve(list.entries.size());
  for (const ListEntry& entry : list.entries) stamps.push_back(entry.timestamp);
  return stamps;
}

std::string with_slashes(std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

/// Ways to find a name that is not where it says.
std::vector<std::string> other_places(const std::string& name, Names folders) {
  const std::string slashed = with_slashes(name);
  const fs::path path(slashed);
  std::vector<std::string> places = {slashed};
  if (path.has_parent_path()) places.push_back((path.parent_path().filename() / path.filename()).string());
  for (const char* folder : folders) places.push_back((fs::path(folder) / path.filename()).string());
  places.push_back(path.filename().string());
  return places;
}

/// Sends a list's names to where its images lie, all in the way the first of them that can be found is found.
void find_images(const FileStore& folder, ImageList& list, Names folders,
                 std::vector<std::string>& warnings) {
  constexpr std::size_t kTried = 5;  // entries: one file may be missing, hardly five in a row
  const std::size_t tried = std::min(kTried, list.entries.size());
  for (std::size_t i = 0; i < tried; ++i)
    if (folder.is_there(list.entries[i].file)) return;
  for (std::size_t i = 0; i < tried; ++i) {
    const auto places = other_places(list.entries[i].file, folders);
    const auto found = std::find_if(places.begin(), places.end(),
                                    [&](const std::string& place) { return folder.is_there(place); });
    if (found == places.end()) continue;
    const auto way = found - places.begin();
    warnings.push_back(fmt::format("{}:{}: there is no {}, but {}; all its names were read so", list.path,
                                   list.entries[i].line, in_quotes(list.entries[i].file), *found));
    for (ListEntry& entry : list.entries) {
      const auto ways = other_places(entry.file, folders);
      entry.file = ways[std::min(static_cast<std::size_t>(way), ways.size() - 1)];
    }
    return;
  }
}

/// A last line that was cut in the middle of its name names nothing.
void drop_cut_name(const FileStore& folder, ImageList& list, std::vector<std::string>& warnings) {
  if (list.entries.size() < 2) return;
  const auto last = std::max_element(list.entries.begin(), list.entries.end(),
                                     [](const auto& a, const auto& b) { return a.line < b.line; });
  const auto& other = list.entries.front().line == last->line ? list.entries[1] : list.entries.front();
  const auto kind = [](const ListEntry& entry) { return fs::path(entry.file).extension(); };
  if (kind(*last) == kind(other) || folder.is_file(last->file)) return;
  warnings.push_back(fmt::format("{}:{}: the last line was cut short in its name {} and skipped", list.path,
                                 last->line, in_quotes(last->file)));
  list.entries.erase(last);
}

ImageList read_image_list(const FileStore& folder, const std::string& name, Names folders,
                          std::vector<std::string>& warnings) {
  const std::string path = folder.path_of(name);
  ImageList list{path, read_list(path, folder.read_text(name), warnings)};
  find_images(folder, list, folders, warnings);
  drop_cut_name(folder, list, warnings);
  return list;
}

void convert(ImageList& list, StampUnit unit, double frame_rate) {
  for (ListEntry& entry : list.entries) entry.timestamp *= seconds_per(unit, frame_rate);
}

/// What a folder without lists holds that looks like a sequence of another kind.
std::string what_else(const FileStore& folder) {
  std::vector<std::string> names;
  for (const std::string& name : folder.entries("")) {
    const std::string kind = fs::path(name).extension().string();
    if (kind == ".bag" || kind == ".mcap" || kind == ".db3" || kind == ".tgz" || kind == ".zip" ||
        kind == ".txt" || kind == ".csv" || folder.is_folder(name))
      names.push_back(name);
  }
  constexpr std::size_t kMost = 6;  // names: a hint, and no listing
  if (names.size() > kMost) names.resize(kMost), names.emplace_back("…");
  return names.empty() ? "" : fmt::format("; it holds {}", fmt::join(names, ", "));
}

void read_paired(const FileStore& folder, const std::string& name, FolderLists& lists) {
  const std::string path = folder.path_of(name);
  lists.colours.path = path;
  lists.depths = ImageList{path, {}};
  lists.paired = true;
  for (ListedPair& pair : read_associations(path, folder.read_text(name), lists.warnings)) {
    lists.colours.entries.push_back(std::move(pair.colour));
    lists.depths->entries.push_back(std::move(pair.depth));
  }
  find_images(folder, lists.colours, kColourFolders, lists.warnings);
  find_images(folder, *lists.depths, kDepthFolders, lists.warnings);
}

/// Images that nothing lists. @return false where there are none
bool read_images_alone(const FileStore& folder, FolderLists& lists) {
  const auto colours = first_there(folder, kColourFolders);
  if (colours) lists.colours = images_of(folder, *colours);
  if (lists.colours.entries.empty()) lists.colours = images_of(folder, "");
  if (lists.colours.entries.empty()) return false;
  if (const auto depths = first_there(folder, kDepthFolders); depths && colours) {
    lists.depths = images_of(folder, *depths);
    lists.paired = lists.depths->entries.size() == lists.colours.entries.size() &&
                   unit_of(stamps_of(lists.colours)) == StampUnit::frames;
    if (lists.depths->entries.empty()) lists.depths.reset();
  }
  lists.warnings.push_back(fmt::format("{}: nothing lists its {} images; they were read by their names",
                                       lists.colours.path, lists.colours.entries.size()));
  return true;
}

}  // namespace

bool has_image_lists(const FileStore& folder) {
  return first_there(folder, kAssociations).has_value() || first_there(folder, kColourLists).has_value();
}

ImageList images_of(const FileStore& store, const std::string& folder,
                    const std::function<bool(const std::string& name)>& is_meant) {
  ImageList list{store.path_of(folder), {}};
  const std::string prefix = folder.empty() ? "" : folder + "/";
  std::vector<fs::path> files;
  for (const std::string& name : store.entries(folder))
    if (is_image_name(name) && (!is_meant || is_meant(name))) files.emplace_back(name);
  std::set<double> stamps;
  bool numbered = true;
  for (const fs::path& file : files) {
    const auto number = number_in(file);
    numbered = numbered && number && stamps.insert(*number).second;
    list.entries.push_back({number.value_or(0.0), prefix + file.string(), 0});
  }
  if (numbered)
    std::sort(list.entries.begin(), list.entries.end(),
              [](const ListEntry& a, const ListEntry& b) { return a.timestamp < b.timestamp; });
  for (std::size_t i = 0; i < list.entries.size(); ++i) {
    list.entries[i].line = static_cast<int>(i) + 1;
    if (!numbered) list.entries[i].timestamp = static_cast<double>(i);
  }
  return list;
}

cv::Size first_size(const FileStore& folder, const ImageList& images) {
  std::string problem;
  for (const ListEntry& entry : images.entries) {
    Bytes bytes;
    const std::string path = folder.path_of(entry.file), fault = folder.read(entry.file, bytes);
    const ImageRead read =
        fault.empty() ? decode_image(path, std::move(bytes)) : ImageRead{{}, path + " " + fault};
    if (!read.image.empty()) return read.image.size();
    if (problem.empty()) problem = read.problem;
  }
  throw InputError(fmt::format("{}: none of its {} images can be read{}{}", images.path,
                               images.entries.size(), problem.empty() ? "" : "; ", problem));
}

void read_mask_list(const FileStore& folder, FolderLists& lists) {
  if (const auto masks = first_there(folder, kMaskLists))
    lists.masks = read_image_list(folder, *masks, kMaskFolders, lists.warnings);
}

StampUnit stamp_unit(const ImageList& list) { return unit_of(stamps_of(list)); }

void settle_stamps(FolderLists& lists, double frame_rate, std::optional<StampUnit> known) {
  lists.unit = known ? *known : stamp_unit(lists.colours);
  convert(lists.colours, lists.unit, frame_rate);
  // A layout that says what its stamps are leaves nothing to wonder at.
  if (!known && lists.unit == StampUnit::frames)
    lists.warnings.push_back(fmt::format(
        "{}: the stamps are frame numbers; they were read as frames at {} Hz (--frame-rate says otherwise)",
        lists.colours.path, frame_rate));
  else if (!known && lists.unit != StampUnit::seconds)
    lists.warnings.push_back(fmt::format("{}: the stamps are {}; they were read as such", lists.colours.path,
                                         to_string(lists.unit)));
  if (lists.unit != StampUnit::frames && frame_rate != kFrameNumberRate)
    lists.warnings.push_back(
        fmt::format("{}: the stamps are {} and no frame numbers, so --frame-rate changes nothing",
                    lists.colours.path, to_string(lists.unit)));
  const auto reference = stamps_of(lists.colours);
  for (std::optional<ImageList>* list : {&lists.depths, &lists.masks}) {
    if (!*list) continue;
    const bool is_known = known && list == &lists.depths;
    const StampUnit unit =
        is_known ? *known
                 : unit_beside(stamps_of(**list), reference, lists.unit, frame_rate, kAssociationTolerance);
    if (unit != lists.unit && !known)
      lists.warnings.push_back(fmt::format("{}: the stamps are {}, where those of {} are {}", (*list)->path,
                                           to_string(unit), lists.colours.path, to_string(lists.unit)));
    convert(**list, unit, frame_rate);
  }
}

FolderLists read_folder_lists(const FileStore& folder, double frame_rate) {
  FolderLists lists;
  const auto explain_unusual = [&](const std::string& name, const char* usual) {
    if (name != usual)
      lists.warnings.push_back(fmt::format("{}: is read in place of {}", folder.path_of(name), usual));
  };
  if (const auto associations = first_there(folder, kAssociations)) {
    explain_unusual(*associations, "associations.txt");
    read_paired(folder, *associations, lists);
  } else if (const auto colours = first_there(folder, kColourLists)) {
    explain_unusual(*colours, "rgb.txt");
    lists.colours = read_image_list(folder, *colours, kColourFolders, lists.warnings);
    if (const auto depths = first_there(folder, kDepthLists)) {
      explain_unusual(*depths, "depth.txt");
      lists.depths = read_image_list(folder, *depths, kDepthFolders, lists.warnings);
    }
  } else if (!read_images_alone(folder, lists)) {
    throw InputError(
        fmt::format("{}: holds neither rgb.txt nor associations.txt nor images, expected a folder in the TUM "
                    "RGB-D layout or another data set's{}",
                    folder.place(), what_else(folder)));
  }
  read_mask_list(folder, lists);
  settle_stamps(lists, frame_rate);
  return lists;
}

}  // namespace stillpoint
