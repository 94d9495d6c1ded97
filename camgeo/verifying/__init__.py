"""Files of any origin, compared with their certificate and their scene."""
