#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/sequence/file_store.hpp"
#include "core/sequence/list_file.hpp"
#include "core/sequence/stamps.hpp"

namespace stillpoint {

/// One list of images of a folder, stamps in seconds.
struct ImageList {
  std::string path;  ///< of the list, or of the folder of images where nothing lists them
  std::vector<ListEntry> entries;
};

/// Which images a folder names.
struct FolderLists {
  ImageList colours;
  std::optional<ImageList> depths, masks;
  std::string why_no_depth;             ///< of a recording that has depth of no use: one sentence
  bool stereo = false;                  ///< `depths` names the right images of a stereo pair
  bool paired = false;                  ///< depth i belongs to colour image i, whatever the stamps say
  StampUnit unit = StampUnit::seconds;  ///< the colour stamps were written in
  std::vector<std::string> warnings;
};

/// Finds and reads the lists of a folder:
/// - `associations.txt` (or `associate.txt`, `association.txt`, `assoc.txt`);
/// - `rgb.txt` (`color.txt`, `colour.txt`, `image.txt`, `images.txt`) and, beside it, `aligned_depth.txt` or
/// `depth.txt`;
/// - where nothing lists them, the images of `rgb/` (`color/`, `colour/`, `image/`, `images/`) and `depth/`
///   (`aligned_depth/`), or those of the folder itself, by name: a name that is a number is a stamp;
/// - `mask.txt` (`masks.txt`).
/// Names with backslashes, names without their folder, and absolute names of another machine are found where
/// the images lie. Stamps are converted to seconds, all lists by the same rules (core/sequence/stamps.hpp).
/// @param frame_rate Hz, of stamps that are frame numbers
/// @throws InputError in one sentence where no images are named, with what was found instead
[[nodiscard]] FolderLists read_folder_lists(const FileStore& folder, double frame_rate);

/// Whether a folder has one of the lists above that name images.
[[nodiscard]] bool has_image_lists(const FileStore& folder);

/// The images of a folder ("" = the store itself) as a list: stamps by their names' numbers where all have
/// one and no two the same, otherwise by their order. Without entries where there are none.
/// @param is_meant whether a file is one of them, by its name; null = every image is
[[nodiscard]] ImageList images_of(const FileStore& store, const std::string& folder,
                                  const std::function<bool(const std::string& name)>& is_meant = nullptr);

/// The size of the first image of a list that can be read.
/// @throws InputError where none can
[[nodiscard]] cv::Size first_size(const FileStore& folder, const ImageList& images);

/// Reads the list of masks, where there is one. @throws InputError for one that cannot be read
void read_mask_list(const FileStore& folder, FolderLists& lists);

/// What the stamps of a list as it was read seem to be.
[[nodiscard]] StampUnit stamp_unit(const ImageList& list);

/// Converts the stamps of all lists to seconds. @param frame_rate Hz, of stamps that are frame numbers
/// @param known the unit of the colour and depth stamps by the layout; nothing = they tell it themselves, and
/// one that is not seconds is told, as is a list in another unit than they
void settle_stamps(FolderLists& lists, double frame_rate, std::optional<StampUnit> known = {});

}  // namespace stillpoint
