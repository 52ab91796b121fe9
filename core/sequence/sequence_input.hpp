#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/sequence/file_store.hpp"
#include "core/sequence/folder_lists.hpp"
#include "core/sequence/folder_truth.hpp"
#include "core/sequence/image_file.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {

/// What a recorded sequence is read from: a folder or an archive of one, or a bag of messages. It names
/// images and gives them as stored; joining, checks and scales are the same for all (ListedSequence). Reading
/// images is const and safe from several threads at once.
class SequenceInput {
 public:
  virtual ~SequenceInput() = default;

  /// For titles.
  [[nodiscard]] virtual std::string name() const = 0;
  /// As messages name it.
  [[nodiscard]] virtual const std::string& place() const = 0;
  /// Which images there are. @throws InputError where there are none
  [[nodiscard]] virtual FolderLists lists() = 0;
  /// @param stamps s, of the colour images, increasing; @param unit what they were written in
  [[nodiscard]] virtual FolderTruth truth(const std::vector<double>& stamps, StampUnit unit) = 0;
  /// The camera, for images of whatever size it says. @throws InputError for a camera that cannot be read
  [[nodiscard]] virtual Camera camera(std::vector<std::string>& warnings) = 0;
  /// An image by its ListEntry::file. Never throws.
  [[nodiscard]] virtual ImageRead image(const std::string& file) const = 0;
  /// Why an image's file has no bytes, as the end of a sentence that begins with its name, by a look at its
  /// entry alone: it is missing or empty. Empty where it has some, or where only reading tells.
  [[nodiscard]] virtual std::string why_no_bytes(const std::string&) const { return {}; }
  /// An image's name as messages have it.
  [[nodiscard]] virtual std::string path_of(const std::string& file) const = 0;
  /// What the input holds, a line each, for the user to choose from; empty where there is nothing to choose.
  [[nodiscard]] virtual std::vector<std::string> contents() const { return {}; }
  /// What is to be told of the input itself.
  [[nodiscard]] virtual std::vector<std::string> warnings() const { return {}; }
};

/// A folder in the TUM RGB-D layout or near it, in another data set's (rgbd/rgbd_recording.hpp), or of stereo
/// pairs; or an archive of one. @throws InputError for one of another layout that cannot be used
[[nodiscard]] std::unique_ptr<SequenceInput> make_folder_input(std::unique_ptr<FileStore> files,
                                                               const OpenOptions& options);

}  // namespace stillpoint
