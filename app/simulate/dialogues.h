#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "app/simulate/files_panel.h"
#include "app/simulate/simulation.h"
#include "app/simulate/view_state.h"

namespace osteomill::app {

/// Whether a dialogue waits for an answer, so that pointer and keys are nobody else's.
bool dialogue_open();

/// What went wrong, until it is sent away.
void draw_complaint(ViewState& view);

/// Asks whether to make the report before the window closes.
void draw_closing(ViewState& view);

/// What can be done with milled bone that a program left which ended without asking.
enum class LeftAnswer { open, remove, later };
std::optional<LeftAnswer> draw_left_milling(const MilledBone& milled);

/// Asks, before bone that was milled and not saved is lost, whether to save it.
class UnsavedQuestion {
 public:
  using Action = std::function<void()>;
  /// `what` loses it. Then `go_on`, once it was saved or is to be lost, or `stay`.
  void ask(std::string what, Action go_on, Action stay = {});
  bool asking() const { return state_ != State::idle; }
  void draw();
  /// Between two pictures, since what it does may be the end of the simulation.
  void proceed(ViewState& view, Simulation& simulation, FilesPanel& files);

 private:
  enum class State { idle, asking, to_save, saving, go_on, stay };

  State state_ = State::idle;
  std::string what_;
  Action go_on_;
  Action stay_;
};

}  // namespace osteomill::app
