"""Published formulas beside which the rows of docs/validation.md are set. SI units."""
import numpy as np

from floe_validation_lines import G, RHO_WATER


def iso_slope(h, width, angle, friction, sigma, young, rubble=0.0, poisson=0.3, ice=920.0,
              water=1010.0, porosity=0.3, repose=40.0, inner=45.0, ice_friction=0.05,
              cohesion=0.0):
    """Horizontal load [N] of a sheet on a slope by ISO 19906 (Croasdale): {"H_B": breaking, "H_P":
    pushing through rubble, "H_R": ride-up, "H_L": lifting rubble, "H_T": turning blocks, "H"}.

    h, width, rubble (height): [m]; angle of the slope, repose, inner friction: [degrees]."""
    a, t, phi = np.radians([angle, repose, inner])
    xi = (np.sin(a) + friction * np.cos(a)) / (np.cos(a) - friction * np.sin(a))
    length = (young * h**3 / (12 * water * G * (1 - poisson**2)))**0.25
    long = width + np.pi**2 / 4 * length
    k = 1 - np.tan(t) / np.tan(a)
    cot = 1 / np.tan(t) - 1 / np.tan(a)
    weight = ice * G * (1 - porosity)
    breaking = 0.68 * xi * sigma * (water * G * h**5 / young)**0.25 * long
    pushing = width * rubble**2 * ice_friction * weight * k**2 / (2 * np.tan(t))
    pressure = (0.5 * ice_friction * (ice_friction + friction) * weight * rubble**2 * np.sin(a)
                * cot * k
                + 0.5 * (ice_friction + friction) * weight * rubble**2 * np.cos(a) / np.tan(a) * k
                + rubble * h * ice * G * (np.sin(a) + friction * np.cos(a)) / np.sin(a))
    ride = width * pressure / (np.cos(a) - friction * np.sin(a))
    lifting = xi * width * rubble * k * (0.5 * (cot + np.tan(phi) * k) * rubble * weight + cohesion)
    turning = 1.5 * width * h**2 * ice * G * np.cos(a) / (np.sin(a) - friction * np.cos(a))
    total = (breaking + pushing + ride + lifting + turning) / (1 - breaking / (sigma * long * h))
    return {"H_B": breaking, "H_P": pushing, "H_R": ride, "H_L": lifting, "H_T": turning,
            "H": total}


def iso_crushing(h, width, strength):
    """Global pressure p = C_R (h/1 m)^n (w/h)^-0.16 [Pa] on a vertical structure (ISO 19906)."""
    n = -0.5 + h / 5 if h < 1 else -0.3
    return strength * h**n * (width / h)**-0.16


def first_failure(h, angle, friction, sigma, young, water=RHO_WATER):
    """Horizontal load per width [N/m] at which a semi-infinite beam on water breaks that is pushed
    against a slope by its lower edge: where 6 M/h^2 - H/h reaches sigma (docs/model.md)."""
    a = np.radians(angle)
    xi = (np.sin(a) + friction * np.cos(a)) / (np.cos(a) - friction * np.sin(a))
    rate = (water * G / (4 * young * h**3 / 12))**0.25
    x = rate * np.linspace(0, 3 / rate, 20001)
    moment = np.exp(-x) * (np.sin(x) / (xi * rate) - 0.5 * h * (np.cos(x) + np.sin(x)))
    return sigma / (6 * moment / h**2 - 1 / h).max()


def edge_uplift(h, sigma, young, water=RHO_WATER):
    """Vertical force per width [N/m] at the edge of a semi-infinite beam on water that breaks it
    (Hetenyi): 0.6804 sigma (rho g h^5/E)^(1/4)."""
    # the moment V/lambda e^-x sin x is largest at x = pi/4
    rate = (water * G / (4 * young * h**3 / 12))**0.25
    return sigma * h**2 / 6 * rate / (np.exp(-np.pi / 4) * np.sin(np.pi / 4))


def thin_floe(length, wave, draft):
    """Amplitudes over the wave's of heave, and of pitch over the wave's slope, of a rigid floe that
    is thin against a wave along it: the pressure of the undisturbed wave at its bottom
    (Froude-Krylov), its weight, its buoyancy and its inertia, no added mass."""
    k = 2 * np.pi / wave
    q, decay = k * length / 2, np.exp(-k * draft)
    inertia = 1 - k * draft
    return (decay * np.sin(q) / q / inertia,
            decay * 3 * (np.sin(q) - q * np.cos(q)) / q**3 / inertia)
