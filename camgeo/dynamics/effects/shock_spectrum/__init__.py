"""Effect `shock-spectrum`: the residual vibration after each move."""
