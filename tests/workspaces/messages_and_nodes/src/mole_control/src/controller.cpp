#include "controller_interface/controller_interface.hpp"
#include "mole_control/depth.hpp"
