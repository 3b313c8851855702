"""What the rows of docs/validation.md measure (tools/validate): the functions by their names in the
specs."""
import floe_validation_ice as ice
import floe_validation_loads as loads
import floe_validation_moored as moored
import floe_validation_sheets as sheets

MEASURES = {function.__name__: function for function in (
    sheets.buckling, sheets.slope_failure, sheets.uplift, sheets.cantilever, sheets.waves,
    loads.iso, loads.crushing, loads.scaling, loads.scatter, loads.wide, loads.endless,
    loads.floe_shape, loads.lock_in, loads.pressure_area, moored.moored, ice.punch, ice.ridging,
    ice.ridge_building, ice.rafting, ice.porosity, ice.shear_box, ice.keel_punch)}
