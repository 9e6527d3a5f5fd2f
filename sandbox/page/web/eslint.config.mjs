import { createRequire } from 'node:module';

// Packages lie beside eslint, not above this file: in the virtual environment.
const require = createRequire(process.argv[1]);
const js = require('@eslint/js');
const globals = require('globals');

export default [
  { ignores: ['.venv/', 'site/', 'build/', 'dist/', 'sandbox/page/bundle.js'] },
  js.configs.recommended,
  {
    rules: {
      'no-var': 'error',
      'prefer-const': 'error',
      eqeqeq: ['error', 'always', { null: 'ignore' }],
      // As for Python: tests/test_architecture.py.
      'max-lines': ['error', 600],
      'max-lines-per-function': ['error', { max: 60 }],
      'max-params': ['error', 12],
    },
  },
  { files: ['sandbox/page/web/*.js'], languageOptions: { globals: globals.browser } },
  { files: ['**/*.mjs'], languageOptions: { globals: globals.node } },
  // It is for pages and for node, and as such no module.
  { files: ['docs/examples/flat/*.js'], languageOptions: { sourceType: 'commonjs', globals: globals.node } },
];
