"""Which structure the recordings choose: causes screened, tried together, refined, selected."""
