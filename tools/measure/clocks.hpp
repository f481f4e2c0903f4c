#pragma once

namespace carom::measure {

/// Processor time of the calling thread [s]: what others take of the machine is not in it.
double thread_seconds();

/// Time on the wall [s], from some moment on.
double wall_seconds();

/// How long one reading of the clock takes that stages are timed with [s].
double seconds_of_a_clock_reading();

}  // namespace carom::measure
