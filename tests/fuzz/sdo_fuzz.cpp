// An SDO client and a server that hear each other through a bus that changes, drops and invents frames.

#include <array>

#include "drivers/emcy.hpp"
#include "drivers/sdo_client.hpp"
#include "drivers/sdo_server.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace steadyboom {
namespace {

using namespace drivers;
using tests::require;

constexpr std::uint8_t node = 0x20;
constexpr std::int64_t timeout_ns = 100'000'000;

CanFrame invented(tests::FuzzInput& input) {
    auto frame = input.any_frame();
    const auto choice = input.byte();
    if (choice >= 64) {
        frame.extended = frame.remote = frame.error = false;
        frame.id = (choice >= 160 ? sdo_request_code : sdo_response_code) + node;
        frame.length = 8;
    }
    return frame;
}

void run(tests::FuzzInput input) {
    std::array<ObjectEntry, 5> dictionary = {{
        {.object = {0x1000, 0}, .size_bytes = 4, .value_raw = 408},
        {.object = {0x1017, 0}, .size_bytes = 2, .access = ObjectAccess::read_write, .value_raw = 100},
        {.object = {0x1018, 1}, .size_bytes = 3, .value_raw = 7},
        {.object = {0x1800, 2},
         .size_bytes = 1,
         .access = ObjectAccess::read_write,
         .value_raw = 1,
         .lowest_raw = 1,
         .highest_raw = 240},
        {.object = {0x1011, 1}, .size_bytes = 4, .access = ObjectAccess::write_only},
    }};
    SdoServer server(node, dictionary);
    SdoClient client(timeout_ns);
    std::int64_t now_ns = input.number<std::int64_t>() >> 2U;
    std::int64_t busy_since_ns = now_ns;
    bool began = false;
    while (!input.empty()) {
        const auto choice = input.byte();
        const auto& entry = dictionary[choice % dictionary.size()];
        if (!client.busy()) {
            busy_since_ns = now_ns;
            if ((choice & 0x80U) != 0) {
                began = client.download(node, entry.object, input.number<std::uint32_t>(), input.byte() % 6) || began;
            } else {
                began = client.upload(node, entry.object) || began;
            }
        }
        if (auto request = client.poll(now_ns)) {
            require(sdo::is_sdo(*request, sdo_request_code), "a request is one");
            if (input.byte() < 16) {
                request->data[input.below(8)] = input.byte();
            }
            const auto answer = server.answer(*request, now_ns);
            if (answer && input.byte() >= 16) {
                require(sdo::is_sdo(*answer, sdo_response_code), "an answer is one");
                (void)client.receive(*answer);
            }
        }
        if (input.byte() < 64) {
            const auto frame = invented(input);
            (void)client.receive(frame);
            (void)server.answer(frame, now_ns);
            if (const auto emergency = decode_emergency(frame)) {
                require(emergency_frame(*emergency, frame.stamp_ns).data == frame.data,
                        "an emergency survives the bus");
                require(!emergency_text(emergency->code).empty(), "and has words");
            }
        }
        for (const auto& object : dictionary) {
            require(object.value_raw <= sdo::low_bytes(0xFFFF'FFFFU, object.size_bytes), "a value fits its size");
            require(object.access == ObjectAccess::write_only || object.value_raw >= object.lowest_raw,
                    "and its limits");
            require(object.value_raw <= object.highest_raw, "and its limits");
        }
        require(dictionary[0].value_raw == 408 && dictionary[2].value_raw == 7, "constants stay");
        require(!began || client.busy() || client.outcome() != SdoClient::Outcome::none,
                "a transfer ends with an outcome");
        require(!client.busy() || now_ns - busy_since_ns <= timeout_ns, "and in time");
        now_ns += input.number<std::uint32_t>() % 60'000'000U;
    }
}

}  // namespace
}  // namespace steadyboom

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    steadyboom::run({data, size});
    return 0;
}
