#pragma once

#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ui/session/session.hpp"
#include "ui/shell/recording.hpp"
#include "ui/workbench/settings.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint {

/// A sequence or a finished run, open and ready for a session.
struct DeskPlace {
  std::shared_ptr<const FrameSource> source;
  Config config;
  SessionOptions options;
  std::string problem;  ///< what is missing though it could be opened, one sentence; empty when all is well
};

/// What a Desk works with.
struct DeskOptions {
  /// Opens a place: a folder, generated:KIND, a run's folder; called on threads of its own, with the config
  /// as it stands. Throws InputError.
  std::function<DeskPlace(const std::string&, const Config&)> open_place;
  Config config{};
  Settings settings{};              ///< look, layout and recent sequences as they were left
  std::string plays_when_opened{};  ///< a sequence that plays at once; empty: none does
  std::function<void()> wake{};     ///< has the interface drawn soon; called from any thread
};

/// The workbench with the sessions it shows: the one place where sequences are opened and left, in the window
/// and offscreen alike. Opening, and waiting for a session to end, happen beside the interface. The GL
/// context it was first drawn in must be current when it goes.
class Desk {
 public:
  explicit Desk(DeskOptions options);
  /// Waits for what is being opened.
  ~Desk();
  Desk(const Desk&) = delete;
  Desk& operator=(const Desk&) = delete;

  /// Opens a sequence soon; when that fails the one open stays, and the workbench says why. Of several asked
  /// for meanwhile, the last is opened.
  void open(const std::string& where);
  /// The same with a place that is open already.
  void show(DeskPlace place, const std::string& where);

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
    std::string where, failure;
    std::optional<DeskPlace> place;
    std::unique_ptr<Session> session;
    int configured = 0;  ///< configured_ when it began
  };

  WorkbenchHost host();
  void begin_opening(const std::string& where, std::optional<DeskPlace> place);
  void take_opened();
  [[nodiscard]] std::unique_ptr<Session> make_session(const DeskPlace& place, const std::string& where) const;

  DeskOptions options_;
  Workbench workbench_;
  std::unique_ptr<Session> session_;
  std::shared_ptr<const FrameSource> given_;  // the one shown first, while it is not in session_ yet
  std::string opened_from_;
  int configured_ = 0;  // how often the config was changed
  std::future<Opened> opening_;
  std::optional<std::string> next_;          // to be opened after that
  std::vector<std::future<void>> retiring_;  // sessions that end
};

}  // namespace stillpoint
