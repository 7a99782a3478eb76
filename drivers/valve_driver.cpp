#include "drivers/valve_driver.hpp"

#include "drivers/cia408_driver.hpp"
#include "drivers/j1939_valve.hpp"

namespace steadyboom::drivers {

std::unique_ptr<ValveDriver> make_valve_driver(const DeviceTable& table) {
    switch (table.config(Device::servo_valve).profile) {
        case ValveProfile::j1939:
            return std::make_unique<J1939Driver>(table);
        case ValveProfile::cia408:
            break;
    }
    return std::make_unique<Cia408Driver>(table);
}

}  // namespace steadyboom::drivers
