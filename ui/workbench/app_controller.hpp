#pragma once

#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ui/session/opened_source.hpp"
#include "ui/shell/recording.hpp"
#include "ui/workbench/settings.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint {

/// What a AppController works with.
struct ControllerOptions {
  /// Opens a folder, a finished run's too, or generated:KIND, to be run with a config; called on threads of
  /// its own. Throws InputError. @param reading how it is to be read, as RecentSequence has it
  std::function<OpenedSource(const std::string& where, const Config& config,
                             const std::vector<std::string>& reading)>
      open_source;
  Config config{};
  Settings settings{};  ///< look, layout and recent sequences as they were left
  /// For marks in sequences that lie where nothing can be written; nothing: no marks are kept anywhere.
  std::optional<std::filesystem::path> marks_folder{};
  std::string plays_when_opened{};  ///< a sequence that plays at once; empty: none does
  std::function<void()> wake{};     ///< has the interface drawn soon; called from any thread
};

/// The workbench with the sessions it shows: the one place where sequences are opened and left, in the window
/// and offscreen alike. Opening, and waiting for a session to end, happen beside the interface. The GL
/// context it was first drawn in must be current when it goes.
class AppController {
 public:
  explicit AppController(ControllerOptions options);
  /// Waits for what is being opened.
  ~AppController();
  AppController(const AppController&) = delete;
  AppController& operator=(const AppController&) = delete;

  /// Opens a sequence soon, as it was left where it was open before; when that fails the one open stays, and
  /// the workbench says why. Of several asked for meanwhile, the last is opened.
  void open(const std::string& where);
  /// The same, read and run as it says, whatever it was left like.
  void open_as(const OpenAs& place);
  /// Opens the sequence shown anew, at the frame shown: its files have changed, or it is to be read
  /// otherwise.
  /// @param with a word of the reading in place of the one of its name: "camera=freiburg1"; empty: none
  void reopen(const std::string& with = {});
  /// The same as open() with what is open already. @param reading how it was read
  void show(OpenedSource place, const std::string& where, std::vector<std::string> reading = {});
  /// Opens the sequence that was open last, if any. @param config null: as it was left
  void open_last(const Config* config);

  /// Has the session do something, as panels ask for it.
  void request(SessionRequest wanted);

  /// Draws the workbench, takes dropped folders, and takes in what was opened.
  void draw(UiFrame& frame);

  /// Nothing is being opened, asked for or worked on.
  [[nodiscard]] bool idle() const;

  [[nodiscard]] std::shared_ptr<const SessionView> view() const {
    return session_ ? session_->view() : nullptr;
  }
  [[nodiscard]] Session* session() { return session_.get(); }
  [[nodiscard]] Workbench& workbench() { return workbench_; }
  [[nodiscard]] const Config& config() const { return options_.config; }
  [[nodiscard]] std::string title() const;  ///< for the window

  /// What is to be remembered.
  [[nodiscard]] Settings settings() const;

  /// How things stand, for the head of a recording.
  [[nodiscard]] RecordingStart recording_start(std::array<int, 2> size) const;

 private:
  struct Opened {
    RecentSequence sequence;  ///< what it is and how it is read
    std::string problem;
    std::optional<OpenedSource> place;
    std::unique_ptr<Session> session;
    int configured = 0;  ///< configured_ when it began
  };

  WorkbenchHost host();
  void begin_opening(RecentSequence sequence, const Config& config, std::optional<OpenedSource> place);
  /// As it was left, where it was open before.
  [[nodiscard]] RecentSequence known_as(const std::string& where) const;
  /// The config a sequence was left with; nothing where it was never open.
  [[nodiscard]] std::optional<Config> config_of(const RecentSequence& sequence);
  [[nodiscard]] Config config_as_left(const std::string& where, const std::vector<std::string>& settings);
  /// Has runs beside the session's made again.
  void bring_back(const std::vector<KeptGhost>& ghosts);
  void take_opened();
  /// Makes the tiles anew by method and kind of sequence, where nobody has chosen them (fitted()).
  void fit_layout(const std::string& method, bool stereo);
  void tell_recent();
  /// The sequence shown, with its constants and frame as they are now.
  [[nodiscard]] RecentSequence as_left() const;
  [[nodiscard]] std::unique_ptr<Session> make_session(const OpenedSource& place,
                                                      const RecentSequence& sequence) const;

  ControllerOptions options_;
  Workbench workbench_;
  std::unique_ptr<Session> session_;
  std::shared_ptr<const FrameSource> given_;  // the one shown first, while it is not in session_ yet
  RecentSequence open_;                       // the sequence shown
  const Session* renewed_ = nullptr;          // the last one opened again because its masks were written
  int configured_ = 0;                        // how often the config was changed
  bool refit_ = false;                        // the method may be another since the last frame
  std::future<Opened> opening_;
  std::optional<std::string> next_;          // to be opened after that
  std::vector<std::future<void>> retiring_;  // sessions that end
};

}  // namespace stillpoint
