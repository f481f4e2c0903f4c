#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace carom {

/// What kind of wrong an `Error` reports. The message says the rest.
enum class ErrorCode : std::uint8_t {
    not_finite,       ///< NaN or infinite where a number is needed
    out_of_range,     ///< a finite number outside its limits
    inconsistent,     ///< two settings that exclude each other
    duplicate_name,   ///< a name that is taken
    unknown_name,     ///< a name that nothing has
    stale_handle,     ///< a `BodyId` or `JointId` of what was removed, or never existed
    too_large,        ///< more bodies or memory than the stated limit
    unsupported_isa,  ///< an instruction set that this build or this machine does not have
    not_built_yet,    ///< part of the format, but not of this version
    malformed,        ///< text that is not what its format says (files only)
    wrong_type,       ///< a value of another type than expected (files only)
    missing,          ///< something required that is not there (files only)
    unreadable,       ///< a file that cannot be opened or read
    interrupted,      ///< a step that `WorldOptions::should_stop` ended
    given_up,         ///< a step that takes more work than its solver allows for the bodies there are
};

/// One thing that is wrong with a description, in pieces, so that a reader of files can say where it stands
/// there.
struct Problem {
    ErrorCode code;
    std::string pointer;    ///< where, as in the scene file: "/bodies/3/shape/disc/radius"
    std::string statement;  ///< what: `body 3 ("ball") has radius -0.4 m; expected ...`
};

/// The one exception type of the library. Thrown at the door only (scene building, `World` calls); what the
/// call would have changed is then unchanged. Only a step that ended early (interrupted, given_up) may have
/// come a part of its way: `World::step` says how far.
///
/// `what()` says where, which item, its value, the limit and the remedy, e.g.
/// `Scene: body 3 ("ball") has radius -0.4 m; expected 0 < radius <= 1e+06 m. Give lengths in metres.`
class Error : public std::invalid_argument {
  public:
    Error(ErrorCode code, const std::string& message) : std::invalid_argument(message), code_(code) {}

    ErrorCode code() const noexcept { return code_; }

  private:
    ErrorCode code_;
};

}  // namespace carom
