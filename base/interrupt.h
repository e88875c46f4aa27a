// Ctrl-C, answered between two steps of work and never inside one.
#pragma once

namespace chladni {

/// Catches SIGINT and SIGTERM from now on; the first one is noted, a second one ends the process.
void catch_interrupts();

/// @throws Interrupted  SIGINT or SIGTERM has arrived since `catch_interrupts()`
void throw_if_interrupted();

/// Whether one has arrived, for a step that can stop with what it has.
[[nodiscard]] bool interrupted();
/// It was answered: work goes on. The next one ends the process as a first one would.
void forget_interrupt();

}  // namespace chladni
