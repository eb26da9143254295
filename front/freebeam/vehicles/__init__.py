"""Vehicles: tables of stiffness and mass in SI units, and the thrust that they bear.

`tables` reads what describes one, `tabulated` assembles its matrices, `vehicle` asks, `report` tells.
"""

from freebeam.vehicles.vehicle import Vehicle, VehicleLoss, VehicleMap, VehicleModes, vehicle

__all__ = ["Vehicle", "VehicleLoss", "VehicleMap", "VehicleModes", "vehicle"]
