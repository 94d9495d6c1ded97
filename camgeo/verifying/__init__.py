"""Files of any origin, held against their certificate and their scene."""
