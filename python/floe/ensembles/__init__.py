"""Many runs of floe: specs, folders, processes."""
