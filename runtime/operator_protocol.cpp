#include "runtime/operator_protocol.hpp"

namespace steadyboom::runtime {

std::string_view name_of(OperatorCommand command) noexcept {
    switch (command) {
        case OperatorCommand::status:
            return "status";
        case OperatorCommand::arm:
            return "arm";
        case OperatorCommand::engage:
            return "engage";
        case OperatorCommand::disengage:
            return "disengage";
        case OperatorCommand::reset:
            return "reset";
        case OperatorCommand::stop:
            return "stop";
    }
    return {};
}

std::string_view name_of(OperatorResult result) noexcept {
    switch (result) {
        case OperatorResult::done:
            return "done";
        case OperatorResult::refused:
            return "refused";
        case OperatorResult::bad_token:
            return "bad token";
        case OperatorResult::unauthorised:
            return "unauthorised";
        case OperatorResult::busy:
            return "busy";
        case OperatorResult::no_answer:
            return "no answer";
        case OperatorResult::rate_limited:
            return "rate limited";
    }
    return {};
}

}  // namespace steadyboom::runtime
