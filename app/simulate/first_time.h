#pragma once

namespace osteomill::app {

/// True until this was called once on this machine by this user: leaves a marker in `state_folder()`. Where
/// none can be left, which is no error, every time is the first.
bool first_time_of_help();

}  // namespace osteomill::app
