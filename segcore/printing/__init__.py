"""Parts as solids that can be printed and put together: connectors, filament slots, the size of the bed."""
